"""Every row of tests/verification/checks.csv against what the programs tests/verification/verify_*.f90 compute."""

import sys

import pytest

from conftest import ROOT, program

sys.path.insert(0, str(ROOT / "tests/verification"))
import catalogue  # noqa: E402
import document  # noqa: E402

ROWS = catalogue.read_rows()


@pytest.mark.parametrize("test", [test for test in catalogue.programs() if not catalogue.is_long(test)])
def test_checks(test):
    """Each row is computed by its program and within its tolerance; nothing is computed that has no row."""
    path = program(f"tests/verification/{test}")
    assert path.exists(), f"{path} is not built: make unit"
    checks, _ = catalogue.run(path)
    filled, wrong = catalogue.fill(ROWS, checks, test)
    wrong += [text for row in filled if (text := catalogue.verdict(row))]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("row", ROWS, ids=[row["name"] for row in ROWS])
def test_row(row):
    """Nothing is allowed more than half the peer's error, and the record of the last `make verify` is within it."""
    assert row["test"] in catalogue.programs()
    assert row["metric"] in catalogue.METRICS
    assert row["quantity"] and row["unit"] and row["source"]
    assert 0 < float(row["tolerance"])
    if row["peer"]:
        assert float(row["tolerance"]) <= 0.5 * float(row["peer"])
    if row["missed"]:
        assert float(row["missed"]) > float(row["tolerance"])
    assert not catalogue.verdict(row)


def test_names_are_unique():
    names = [row["name"] for row in ROWS]
    assert len(set(names)) == len(names) > 0


def test_document():
    """doc/verification.md shows each row once, as it stands in checks.csv, and pictures that are there."""
    text = document.DOCUMENT.read_text()
    assert document.render(text, ROWS) == text, "make verify has not been run since checks.csv changed"
    tables = document.tables_in(text)
    assert sorted(tables) == sorted({row["table"] for row in ROWS})
    for picture in (ROOT / "doc/verification").glob("*.png"):
        assert f"verification/{picture.name}" in text
    for shown in document.pictures_in(text):
        assert (document.DOCUMENT.parent / shown).exists()


@pytest.mark.parametrize(
    "error, tolerance, missed, message",
    [
        ("0.1", "0.2", "", ""),
        ("0.3", "0.2", "", "allowed 0.2"),
        ("nan", "0.2", "", "allowed 0.2"),
        ("nan", "0.2", "0.4", "allowed 0.2"),
        ("0.3", "0.2", "0.4", ""),
        ("0.5", "0.2", "0.4", "no more than 0.4"),
        ("0.1", "0.2", "0.4", "met at last"),
    ],
)
def test_verdict(error, tolerance, missed, message):
    row = {"name": "x", "metric": "absolute", "expected": "0", "computed": error, "tolerance": tolerance, "missed": missed}
    told = catalogue.verdict(row)
    assert message in told and bool(told) == bool(message)


def test_relative_error():
    row = {"metric": "relative", "expected": "-4", "computed": "-5"}
    assert catalogue.error_of(row) == 0.25


def test_names_must_match():
    rows = [{"name": "a", "test": "t", "expected": "", "computed": ""}, {"name": "b", "test": "t", "expected": "", "computed": ""}]
    filled, wrong = catalogue.fill(rows, {"a": (1.0, 2.0), "c": (1.0, 2.0)}, "t")
    assert [(row["computed"], row["expected"]) for row in filled] == [("1", "2")]
    assert wrong == ["t writes c, which has no row", "b is written by no test"]

"""Case files with mistakes: every one is reported, at its line, and nothing is written.

Each file tests/input/NN_name.nml says in its first lines, '! expect: ...', what the report must hold: one such
line for every mistake, and no mistake without one.
"""

import re

import pytest

from conftest import ROOT

FOLDER = ROOT / "tests/input"


def expected(path):
    lines = path.read_text().splitlines()
    return [line.removeprefix("! expect: ") for line in lines if line.startswith("! expect: ")]


@pytest.mark.parametrize("path", sorted(FOLDER.glob("[0-9]*.nml")), ids=lambda path: path.stem)
def test_mistake(path, geldart, tmp_path):
    done = geldart(path)
    messages = expected(path)
    for message in messages:
        assert any(message in line for line in done.stderr.splitlines()), f"not found: {message}\n{done.stderr}"
    counted = re.search(r"^([0-9]+) mistakes?;", done.stderr, re.MULTILINE)
    assert int(counted.group(1)) == len(messages) > 0, done.stderr
    assert done.returncode == 2, done.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("path", sorted(FOLDER.glob("good_*.nml")), ids=lambda path: path.stem)
def test_good(path, geldart, tmp_path):
    done = geldart(path, "--check")
    assert done.returncode == 0, done.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "setting, message",
    [
        ("contact%restitution=1.4", "command line: &contact restitution = 1.4: must lie in [0.01, 1]"),
        ("contct%friction=0.1", "command line: &contct: there is no such group; did you mean &contact?"),
        ("contact%fricton=0.1", "command line: &contact fricton = 0.1: there is no such key; did you mean friction?"),
        ("boundary%velocity=1", "command line: &boundary: there are 2 records; say which"),
        ("boundary(lid)%velocity=1", "command line: &boundary(lid): there is no such record"),
        ("boundary(outlet)%velocity=1", "command line: &boundary(outlet) velocity = 1 m/s: belongs to an inflow"),
        ("weight", "command line: --set weight: write --set group%key=value"),
    ],
)
def test_wrong_override(setting, message, geldart):
    done = geldart(FOLDER / "parts/bed.nml", "--check", "--set", setting)
    assert done.returncode == 2
    assert message in done.stderr


@pytest.mark.parametrize("setting", ["contact%friction=0.1", "boundary(inlet)%velocity=1", "boundary(1)%velocity = 1",
                                     "parcels%weighting=dem", "run%title=it's / a title", "grid%cells=12 40 2"])
def test_override(setting, geldart):
    done = geldart(FOLDER / "parts/bed.nml", "--check", "--set", setting)
    assert done.returncode == 0, done.stderr


def test_wrong_options(geldart):
    done = geldart("a.nml", "b.nml", "--chekc", "--out")
    assert done.returncode == 2
    for message in ("b.nml: there is one case file already", "--chekc: there is no such option; did you mean --check?",
                    "--out needs a value"):
        assert message in done.stderr


def test_no_file(geldart):
    done = geldart("nowhere.nml")
    assert done.returncode == 2
    assert "nowhere.nml: cannot be read" in done.stderr


def test_help(geldart):
    done = geldart("--help", "contact")
    assert done.returncode == 0
    assert "restitution" in done.stdout and "[0.01, 1], default 0.9" in done.stdout


def test_inputs_page_is_current(geldart):
    """doc/inputs.md is what the program says: build/geldart --markdown > doc/inputs.md."""
    assert geldart("--markdown").stdout == (ROOT / "doc/inputs.md").read_text()

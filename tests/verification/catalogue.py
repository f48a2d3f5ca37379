"""The rows of checks.csv, what the programs verify_*.f90 compute for them, and how the one is judged by the other.

Of a row everything is written by hand but `expected` and `computed`, which `make verify` fills in. The error is
|computed - expected|, over |expected| where the metric is `relative`.

tolerance  largest error allowed
peer       MFIX's error in the same scene; the tolerance is at most half of it
missed     given where the tolerance is not met yet: what the error may not exceed meanwhile. A row that meets its
           tolerance may not have it.
"""

import csv
import math
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CHECKS = ROOT / "tests/verification/checks.csv"
FILLED = ("expected", "computed")
METRICS = ("absolute", "relative")


def read_rows():
    with CHECKS.open(newline="") as file:
        return list(csv.DictReader(file))


def write_rows(rows):
    with CHECKS.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def programs():
    """Names of all verification programs."""
    return sorted(source.stem for source in (ROOT / "tests/verification").glob("verify_*.f90"))


def is_long(program):
    """Whether a program says of itself, '! long: why', that `make verify` alone runs it."""
    return "\n! long: " in (ROOT / f"tests/verification/{program}.f90").read_text()


def run(program):
    """What a built program printed: {name: (computed, expected)} of its checks, {name: points} of its curves.

    A point is (x, computed, expected). It runs on one rank, or as many as a comment '! ranks: 2' of its source asks for.
    """
    source = (ROOT / f"tests/verification/{Path(program).name}.f90").read_text()
    asked = re.search(r"^! ranks: (\d+)$", source, re.MULTILINE)
    launch = ["sh", str(ROOT / "src/build/launch.sh"), asked[1] if asked else "1", str(program)]
    done = subprocess.run(launch, capture_output=True, text=True, timeout=600)
    words = [line.split() for line in done.stdout.splitlines()]
    failed = [" ".join(w) for w in words if w and w[0] == "FAIL"]
    if done.returncode or failed or ["finished"] not in words:
        raise RuntimeError("\n".join([f"{program}: exit {done.returncode}", *failed[:5], done.stderr[-2000:]]))
    checks, curves = {}, {}
    for kind, name, *numbers in (w for w in words if w[0] in ("check", "point")):
        values = tuple(map(float, numbers))
        if kind == "point":
            curves.setdefault(name, []).append(values)
        elif name in checks:
            raise RuntimeError(f"{program}: two checks named {name}")
        else:
            checks[name] = values
    return checks, curves


def error_of(row):
    computed, expected = float(row["computed"]), float(row["expected"])
    return abs(computed - expected) / (abs(expected) if row["metric"] == "relative" else 1.0)


def verdict(row):
    """What is wrong with a filled row; empty if nothing is."""
    error, tolerance = error_of(row), float(row["tolerance"])
    text = f"{row['name']}: error {error:.3g}, allowed {tolerance:g}"
    if not math.isfinite(error):
        return text
    if not row["missed"]:
        return "" if error <= tolerance else text
    if error <= tolerance:
        return f"{text}: met at last, take {row['missed']} out of its column `missed`"
    return "" if error <= float(row["missed"]) else f"{text}, known to be missed by no more than {row['missed']}"


def fill(rows, checks, test):
    """The rows of one program with what it computed; and what is wrong with its names."""
    own = [row for row in rows if row["test"] == test]
    names = {row["name"] for row in own}
    wrong = [f"{test} writes {name}, which has no row" for name in checks if name not in names]
    wrong += [f"{name} is written by no test" for name in sorted(names) if name not in checks]
    filled = [row | dict(zip(("computed", "expected"), map("{:.9g}".format, checks[row["name"]]), strict=True))
              for row in own if row["name"] in checks]
    return filled, wrong

"""Run every tests/bench/bench_*.f90 and collect what they measured.

usage: run.py build/release build/bench.json

A program prints lines 'bench NAME VALUE UNIT', kept as {NAME: {"value": VALUE, "unit": UNIT}}. A comment
'! ranks: 1 2' among its first lines asks for those numbers of ranks instead of one; then NAME ends in _RANKS.
"""

import json
import os
import platform
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BEDS = ROOT / "build/beds"  # what a program makes for itself once


def ranks_of(source):
    asked = re.search(r"^!>? *ranks: *([0-9 ]+)$", "\n".join(source.read_text().splitlines()[:20]), re.MULTILINE)
    return [int(n) for n in asked.group(1).split()] if asked else [1]


def processor():
    try:
        names = re.findall(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
    except OSError:
        names = []
    return names[0] if names else platform.machine()


def measure(program, ranks):
    """One run: what it measured, and the lines it printed."""
    command = ["sh", str(ROOT / "src/build/launch.sh"), str(ranks), str(program), str(BEDS)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    if done.returncode:
        sys.exit(f"{program.name} on {ranks} ranks: exit {done.returncode}\n{done.stdout}{done.stderr}")
    print(f"{program.name} on {ranks} ranks\n{done.stdout}", flush=True)
    words = [line.split() for line in done.stdout.splitlines()]
    end = f"_{ranks}" if ranks > 1 else ""
    return {w[1] + end: {"value": float(w[2]), "unit": w[3]} for w in words if len(w) == 4 and w[0] == "bench"}


def main(build, result):
    measured = {}
    BEDS.mkdir(exist_ok=True)
    for source in sorted((ROOT / "tests/bench").glob("bench_*.f90")):
        for ranks in ranks_of(source):
            measured |= measure(ROOT / build / "tests/bench" / source.stem, ranks)
    Path(result).write_text(json.dumps(measured, indent=1) + "\n")
    print(f"{processor()}, {os.cpu_count()} cores")
    print(f"written to {result}")


if __name__ == "__main__":
    main(*sys.argv[1:])

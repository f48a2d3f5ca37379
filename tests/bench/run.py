"""Run every tests/bench/bench_*.f90 and collect what they measured.

usage: run.py build/release build/bench.json

A program prints lines 'bench NAME VALUE UNIT'; all it prints is kept as well. A comment
'! ranks: 1 2' among its first lines asks for those numbers of ranks instead of one.
"""

import json
import os
import platform
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


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
    command = ["sh", str(ROOT / "src/build/launch.sh"), str(ranks), str(program)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    if done.returncode:
        sys.exit(f"{program.name} on {ranks} ranks: exit {done.returncode}\n{done.stdout}{done.stderr}")
    print(f"{program.name} on {ranks} ranks\n{done.stdout}", flush=True)
    words = [line.split() for line in done.stdout.splitlines()]
    measured = {w[1]: {"value": float(w[2]), "unit": w[3]} for w in words if len(w) == 4 and w[0] == "bench"}
    return {"program": program.name, "ranks": ranks, "measured": measured, "printed": done.stdout.splitlines()}


def main(build, result):
    sources = sorted((ROOT / "tests/bench").glob("bench_*.f90"))
    runs = [measure(ROOT / build / "tests/bench" / source.stem, ranks) for source in sources for ranks in ranks_of(source)]
    machine = {"processor": processor(), "cores": os.cpu_count()}
    Path(result).write_text(json.dumps({"machine": machine, "runs": runs}, indent=1) + "\n")
    print(f"written to {result}")


if __name__ == "__main__":
    main(*sys.argv[1:])

"""Run every tests/bench/bench_*.f90 and collect what they measured.

usage: run.py build/release build/bench.json

A program prints lines 'bench NAME VALUE UNIT'; other lines pass to the screen. A comment
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
    command = ["sh", str(ROOT / "src/build/launch.sh"), str(ranks), str(program)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    if done.returncode:
        sys.exit(f"{program.name} on {ranks} ranks: exit {done.returncode}\n{done.stdout}{done.stderr}")
    for line in done.stdout.splitlines():
        words = line.split()
        if len(words) == 4 and words[0] == "bench":
            print(f"{program.name[6:]:20} {ranks:3}  {words[1]:40} {float(words[2]):12.4g} {words[3]}", flush=True)
            yield {"program": program.name, "ranks": ranks, "name": words[1], "value": float(words[2]), "unit": words[3]}
        else:
            print(line)


def main(build, result):
    measured = []
    for source in sorted((ROOT / "tests/bench").glob("bench_*.f90")):
        for ranks in ranks_of(source):
            measured += measure(ROOT / build / "tests/bench" / source.stem, ranks)
    if not measured:
        sys.exit("there are no bench programs in tests/bench")
    machine = {"processor": processor(), "cores": os.cpu_count()}
    Path(result).write_text(json.dumps({"machine": machine, "measured": measured}, indent=1) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])

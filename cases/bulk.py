"""What the cases of bulk solids share: one case run with several values of a key, a table of what was found, checks.

The runs go into results/ beside the case, as many at a time as there are cores. A table names the program, its commit,
what made it and the seed.
"""

import csv
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py

ROOT = Path(__file__).resolve().parents[1]
SEED = 1


def run_all(here, variants, program):
    """Run case.nml of a folder with the keys of each variant, {name: ["group%key=value", ...]}; {name: folder of results}.

    The seed is SEED where a variant names none.
    """

    def run(name):
        out = here / "results" / name
        shutil.rmtree(out, ignore_errors=True)
        sets = variants[name]
        if not any(option.startswith("parcels%seed=") for option in sets):
            sets = [f"parcels%seed={SEED}", *sets]
        command = ["sh", str(ROOT / "src/build/launch.sh"), "1", str(program), str(here / "case.nml"), "--out", str(out),
                   *(word for option in sets for word in ("--set", option))]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(f"{' '.join(command)}\nended with {done.returncode}\n{done.stderr[-2000:]}")
        return out

    with ThreadPoolExecutor(os.cpu_count()) as cores:
        return dict(zip(variants, cores.map(run, variants), strict=True))


def program():
    """The program named on the command line, else the one that was built."""
    return sys.argv[1] if len(sys.argv) > 1 and sys.argv[1] != "--read" else str(ROOT / "build/geldart")


def write_table(path, header, rows, *remarks, seeds=(SEED,), results=None):
    """The program is that of the command line, or the one that has written into a folder of results."""
    if results:
        with h5py.File(results / "monitor.h5") as file:
            version = "geldart {version}, commit {commit}".format(**{k: v.decode() for k, v in file["geldart"].attrs.items()})
    else:
        version = subprocess.run([program(), "--version"], capture_output=True, text=True, check=True).stdout.strip()
    with path.open("w", newline="") as file:
        file.write(f"# {version}; cases/{path.parent.name}/validate.py; seed {' and '.join(map(str, seeds))}\n")
        file.writelines(f"# {remark}\n" for remark in remarks)
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows([f"{value:.5g}" if isinstance(value, float) else value for value in row] for row in rows)


class Checks:
    """Prints each check; `failed` counts those that are out of range."""

    failed = 0

    def __call__(self, what, value, low, high):
        right = low <= value <= high
        self.failed += not right
        print(f"  {'ok  ' if right else 'FAIL'}  {what:58} {value:8.4f}   ({low:g} to {high:g})")

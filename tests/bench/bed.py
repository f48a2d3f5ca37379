"""Wall time of the bubbling bed of cases/geldart_b_bed, which MFIX was timed on, per simulated second.

usage: bed.py build/bench.json      adds to it

All is timed over 0.2 s after the first 0.1 s, in which the bed begins to bubble. Machines are slower in some seconds than in others,
and when all their cores are busy: the run on two ranks takes turns with one on one rank, and with two of these at once, the most that
two cores can do.
"""

import json
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
from run import ROOT

CASE = ROOT / "cases/geldart_b_bed/case.nml"
START, END = 0.1, 0.3
RUNS = {  # name: settings, on one rank
    "ssp_0.45": ["boundary(distributor)%velocity=0.45"],
    "ssp_0.25": ["boundary(distributor)%velocity=0.25"],
    "ssw_0.45": ["boundary(distributor)%velocity=0.45", "parcels%weighting=ssw"],
    "ssp_0.45_tc50": ["boundary(distributor)%velocity=0.45", "numerics%steps_per_collision=50"],
}
TURNS = 5


def start(name, settings, ranks=1):
    """The run, which goes on."""
    words = [w for s in [*settings, f"run%end_time={END}", "output%monitor_interval=0.01"] for w in ("--set", s)]
    return subprocess.Popen(["sh", str(ROOT / "src/build/launch.sh"), str(ranks), "build/geldart", str(CASE), "--out", str(folder(name)),
                             "--force", *words], cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def folder(name):
    return ROOT / "build/bench_bed" / name


def seconds_of(name, run):
    """Wall seconds per simulated second of all, and of its parts, when the run has ended."""
    if run.wait() != 0:
        sys.exit(f"bed.py: the run {name} failed")
    with h5py.File(folder(name) / "monitor.h5") as file:
        series = {key: file["series"][key][()] for key in file["series"]}
    time = series["time"]
    first = np.argmin(abs(time - START))
    return {key: (series[key][-1] - series[key][first]) / (time[-1] - time[first])
            for key in series if key.startswith("wall_time")}


def measure(name, settings, ranks=1):
    return seconds_of(name, start(name, settings, ranks))


def take_turns(settings):
    """Of one rank, of two, and of two runs on one rank each at once, the mean of all turns: [s/s]."""
    alone, two, at_once = [], [], []
    for _ in range(TURNS):
        alone.append(measure("alone", settings)["wall_time"])
        two.append(measure("two", settings, 2)["wall_time"])
        runs = {name: start(name, settings) for name in ("this", "that")}
        at_once += [seconds_of(name, run)["wall_time"] for name, run in runs.items()]
    return np.mean(alone), np.mean(two), np.mean(at_once)


def main(result):
    path = Path(result)
    measured = json.loads(path.read_text()) if path.exists() else {}
    for name, settings in RUNS.items():
        for part, seconds in measure(name, settings).items():
            key = f"bed_{name}{part.removeprefix('wall_time')}"
            measured[key] = {"value": round(float(seconds), 3), "unit": "s/s"}
            print(f"{key:32} {seconds:8.2f} wall seconds per simulated second", flush=True)
    alone, two, at_once = take_turns(RUNS["ssp_0.45"])
    for key, value, unit in (("bed_ssp_0.45_2", two, "s/s"), ("bed_two_ranks_speedup", alone / two, "1"),
                             ("bed_two_ranks_efficiency", at_once / (2 * two), "1")):
        measured[key] = {"value": round(float(value), 3), "unit": unit}
        print(f"{key:32} {value:8.3f} {unit}", flush=True)
    path.write_text(json.dumps(measured, indent=1) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])

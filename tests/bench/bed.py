"""Wall time of the bubbling bed of cases/geldart_b_bed, which MFIX was timed on, per simulated second.

usage: bed.py build/bench.json      adds to it

All is timed over 0.2 s after the first 0.1 s, in which the bed begins to bubble. Machines are slower in some seconds than in others,
and when all their cores are busy: the run on two ranks takes turns with one on one rank, and with two of these at once, the most that
two cores can do. What two ranks gain undisturbed is that of the least times of all turns, interval by interval.
"""

import json
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
from run import ROOT

CASE = ROOT / "cases/geldart_b_bed/case.nml"
START, END, INTERVAL = 0.1, 0.3, 0.01
RUNS = {  # name: settings, on one rank
    "ssp_0.45": ["boundary(distributor)%velocity=0.45"],
    "ssp_0.25": ["boundary(distributor)%velocity=0.25"],
    "ssw_0.45": ["boundary(distributor)%velocity=0.45", "parcels%weighting=ssw"],
    "ssp_0.45_tc50": ["boundary(distributor)%velocity=0.45", "numerics%steps_per_collision=50"],
}
TURNS = 7


def start(name, settings, ranks=1):
    """The run, which goes on."""
    words = [w for s in [*settings, f"run%end_time={END}", f"output%monitor_interval={INTERVAL}"] for w in ("--set", s)]
    return subprocess.Popen(["sh", str(ROOT / "src/build/launch.sh"), str(ranks), "build/geldart", str(CASE), "--out", str(folder(name)),
                             "--force", *words], cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def folder(name):
    return ROOT / "build/bench_bed" / name


def seconds_of(name, run):
    """Wall seconds per simulated second of all, and of its parts, in every interval of the monitor, when the run has ended."""
    if run.wait() != 0:
        sys.exit(f"bed.py: the run {name} failed")
    with h5py.File(folder(name) / "monitor.h5") as file:
        series = {key: file["series"][key][()] for key in file["series"]}
    ends = START + np.arange(round((END - START) / INTERVAL) + 1) * INTERVAL
    return {key: np.diff(np.interp(ends, series["time"], series[key])) / INTERVAL for key in series if key.startswith("wall_time")}


def measure(name, settings, ranks=1):
    return seconds_of(name, start(name, settings, ranks))


def take_turns(settings):
    """Of one rank, of two, and of two runs on one rank each at once: (turns, intervals) [s/s]."""
    alone, two, at_once = [], [], []
    for _ in range(TURNS):
        alone.append(measure("alone", settings)["wall_time"])
        two.append(measure("two", settings, 2)["wall_time"])
        runs = {name: start(name, settings) for name in ("this", "that")}
        at_once.append(np.mean([seconds_of(name, run)["wall_time"] for name, run in runs.items()], axis=0))
    return np.array(alone), np.array(two), np.array(at_once)


def main(result):
    path = Path(result)
    measured = json.loads(path.read_text()) if path.exists() else {}
    for name, settings in RUNS.items():
        for part, seconds in measure(name, settings).items():
            key = f"bed_{name}{part.removeprefix('wall_time')}"
            measured[key] = {"value": round(float(seconds.mean()), 3), "unit": "s/s"}
            print(f"{key:32} {seconds.mean():8.2f} wall seconds per simulated second", flush=True)
    alone, two, at_once = take_turns(RUNS["ssp_0.45"])
    for key, value, unit in (("bed_ssp_0.45_2", two.mean(), "s/s"),
                             ("bed_two_ranks_speedup", alone.mean() / two.mean(), "1"),
                             ("bed_two_ranks_undisturbed", alone.min(0).mean() / two.min(0).mean(), "1"),
                             ("bed_two_ranks_efficiency", at_once.mean() / (2 * two.mean()), "1")):
        measured[key] = {"value": round(float(value), 3), "unit": unit}
        print(f"{key:32} {value:8.3f} {unit}", flush=True)
    path.write_text(json.dumps(measured, indent=1) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])

"""Wall time of the bubbling bed of cases/geldart_b_bed, which MFIX was timed on, per simulated second.

usage: bed.py build/bench.json      adds to it

Four runs on one rank and one on two: 0.2 s after the first 0.1 s, in which the bed begins to bubble.
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
RUNS = {  # name: ranks, settings
    "ssp_0.45": (1, ["boundary(distributor)%velocity=0.45"]),
    "ssp_0.25": (1, ["boundary(distributor)%velocity=0.25"]),
    "ssw_0.45": (1, ["boundary(distributor)%velocity=0.45", "parcels%weighting=ssw"]),
    "ssp_0.45_tc50": (1, ["boundary(distributor)%velocity=0.45", "numerics%steps_per_collision=50"]),
    "ssp_0.45_2": (2, ["boundary(distributor)%velocity=0.45"]),
}


def measure(name, ranks, settings):
    """Wall seconds per simulated second of all, and of its parts."""
    out = ROOT / "build/bench_bed" / name
    words = [w for s in [*settings, f"run%end_time={END}", "output%monitor_interval=0.01"] for w in ("--set", s)]
    subprocess.run(["sh", str(ROOT / "src/build/launch.sh"), str(ranks), "build/geldart", str(CASE), "--out", str(out), "--force",
                    *words], check=True, cwd=ROOT, capture_output=True)
    with h5py.File(out / "monitor.h5") as file:
        series = {key: file["series"][key][()] for key in file["series"]}
    time = series["time"]
    first = np.argmin(abs(time - START))
    return {key: (series[key][-1] - series[key][first]) / (time[-1] - time[first])
            for key in series if key.startswith("wall_time")}


def main(result):
    path = Path(result)
    measured = json.loads(path.read_text()) if path.exists() else {}
    for name, (ranks, settings) in RUNS.items():
        for part, seconds in measure(name, ranks, settings).items():
            key = f"bed_{name}{part.removeprefix('wall_time')}"
            measured[key] = {"value": round(float(seconds), 3), "unit": "s/s"}
            print(f"{key:32} {seconds:8.2f} wall seconds per simulated second", flush=True)
    path.write_text(json.dumps(measured, indent=1) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])

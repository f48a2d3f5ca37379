"""Whether what a bed does depends on cells narrower than its parcels: usage: validate.py [PROGRAM]

The same bed, packed and fluidized, in cells as wide as the parcels, half and a quarter of that, with several widths of the
coupling. Runs the program itself, and writes results/, wide.csv and wide.png beside this file. Exits with 1 where something is
not as README.md says it must be.
"""

import csv
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE.parent))
from results import Run  # noqa: E402

PARCEL = 1.5e-3  # m
CELLS = {1: "9 24 3", 2: "18 48 6", 4: "36 96 12"}  # per width of a parcel
WIDTHS = (None, 0.5, 0.7, 1.0)  # over that of a parcel
DENSITY, SOLID, GRAVITY = 1.2, 2500.0, 9.81
# velocity m/s, end s, first time that counts s, height m below which all is bed
STATES = {"packed": (0.12, 0.12, 0.1, 0.0105), "fluidized": (0.5, 0.6, 0.2, 0.0105)}
POINTS = [(state, cells, width) for state in STATES for width in WIDTHS for cells in CELLS
          if (width or cells == 1) and (state == "packed" or width != 0.7)]


def keys_of(state, cells, width):
    """Where the mapping alone is wider than the width nothing is spread."""
    velocity, end, *_ = STATES[state]
    return [f"grid%cells={CELLS[cells]}", f"boundary(distributor)%velocity={velocity}", f"run%end_time={end}",
            f"coupling%width={(width or 1e-3) * PARCEL}"]


VARIANTS = {"{}_{}_{}".format(*point): keys_of(*point) for point in POINTS}


def run_case(program, folder, *options):
    command = ["sh", str(ROOT / "src/build/launch.sh"), "1", str(program), str(HERE / "case.nml"), "--out", str(folder), "--force",
               *(word for option in options for word in ("--set", option))]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(command)}\nended with {done.returncode}\n{done.stderr}")


def measure(program, state, cells, width):
    """Pressure drop over weight, mean and standard deviation of the void fraction in the bed, its least, and what is hidden."""
    *_, first, height = STATES[state]
    name = f"{state}_{cells}_{width}"
    folder = HERE / "results" / name
    run_case(program, folder, *VARIANTS[name])
    run = Run(folder)
    late = run.series["time"] > first
    gas_weight = DENSITY * GRAVITY * (run.gas.upper[1] - run.gas.lower[1])
    ratio = (run.series["pressure_drop"][late] - gas_weight) / run.series["weight_per_area"][late]
    frames = [s for s in range(run.gas.count) if run.gas.times[s] > first]
    below = (np.arange(run.gas.cells[1]) + 0.5) * run.gas.h[1] < height
    eps = np.array([run.gas("void_fraction", s)[:, below, :] for s in frames])
    return SimpleNamespace(state=state, cells=cells, width=width, ratio=ratio.mean(), swing=ratio.std(), eps=eps.mean(),
                           spread=eps.std(axis=(1, 2, 3)).mean(), least=eps.min(),
                           hidden=(run.series["clipped_volume"][late] / (run.series["parcel_mass"][late] / SOLID)).max())


def write_table(program, points):
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    with open(HERE / "wide.csv", "w", newline="") as file:
        file.write(f"# {version}; cases/wide_parcels/validate.py; seed 5\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["state", "cells_per_parcel", "width_over_parcel", "pressure_drop_over_weight", "its_standard_deviation",
                         "void_fraction", "its_standard_deviation_over_cells", "least", "hidden_share"])
        writer.writerows([p.state, p.cells, p.width or "", f"{p.ratio:.4f}", f"{p.swing:.4f}", f"{p.eps:.4f}", f"{p.spread:.4f}",
                          f"{p.least:.3f}", f"{p.hidden:.1e}"] for p in points)


def draw(points):
    figure, axes = plt.subplots(1, 3, figsize=(9, 3), constrained_layout=True)
    for axis, (state, what, label) in zip(axes, (("packed", "ratio", "packed: pressure drop over weight"),
                                                 ("packed", "spread", "packed: standard deviation of the void fraction"),
                                                 ("fluidized", "ratio", "fluidized: pressure drop over weight")), strict=True):
        for k, width in enumerate(WIDTHS):
            line = [p for p in points if p.state == state and p.width == width]
            name = f"width {width:g} D" if width else "trilinear alone"
            axis.plot([1 / p.cells for p in line], [getattr(p, what) for p in line], "o-", color=f"C{k}", label=name)
        axis.set(xscale="log", xlabel="cell over parcel")
        axis.set_xticks([0.25, 0.5, 1], ["1/4", "1/2", "1"])
        axis.minorticks_off()
        axis.set_title(label, fontsize=8)
    axes[0].set_ylim(0.2, 0.3)
    axes[1].set_ylim(0, None)
    axes[2].set_ylim(0.8, 1.2)
    axes[0].legend(fontsize=7)
    figure.savefig(HERE / "wide.png", dpi=90)


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "build/geldart")
    points = [measure(program, *point) for point in POINTS]
    write_table(program, points)
    draw(points)
    failed = 0

    def check(what, value, low, high):
        nonlocal failed
        failed += not low <= value <= high
        print(f"  {'ok  ' if low <= value <= high else 'FAIL'}  {what:66} {value:7.4f}   ({low:g} to {high:g})")

    for state in STATES:
        for width in WIDTHS[1:]:
            line = [p for p in points if (p.state, p.width) == (state, width)]
            if not line:
                continue
            one, two, four = line
            name = f"{state}, width {width:g} D"
            check(f"{name}: pressure drop in cells of D over that of D/4", one.ratio / four.ratio, 0.95, 1.05)
            check(f"{name}: pressure drop in cells of D/2 over that of D/4", two.ratio / four.ratio, 0.97, 1.03)
            check(f"{name}: void fraction, D/2 over D/4", two.eps / four.eps, 0.97, 1.03)
            if width >= 0.7:
                check(f"{name}: its standard deviation, D/2 over D/4", two.spread / four.spread, 0.85, 1.15)
                check(f"{name}: solids hidden by the least void fraction", max(p.hidden for p in (one, two, four)), 0, 1e-4)
            if state == "fluidized":
                check(f"{name}: pressure drop over weight, D/4", four.ratio, 0.93, 1.07)
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()

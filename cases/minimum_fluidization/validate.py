"""Finds the minimum fluidization velocity of the bed, as SSP and as SSW: usage: validate.py [PROGRAM]

As in the laboratory: the bed bubbles, then the gas is throttled step by step, each step continuing the one before,
and the bed settles. Umf is where the pressure drop of the packed bed, a U + b U^2 through the velocities that do
not lift it, reaches the weight of the bed. Runs the program itself, three seeds of each weighting on as many cores as
there are, and writes results/, umf.csv and umf.png beside this file. Exits with 1 where something is not as README.md
says it must be.
"""

import csv
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE.parent))
from fluidization import DENSITY, GRAVITY, carrying_velocity, crossing, step_through  # noqa: E402
from results import Run  # noqa: E402

WEIGHTINGS = ("ssp", "ssw")
SEEDS = (1, 2, 3)
VARIANTS = {f"{w}_{seed}": [f"parcels%weighting='{w}'", f"parcels%seed={seed}"] for w in WEIGHTINGS for seed in SEEDS}
VELOCITIES = (0.44, 0.40, 0.37, 0.34, 0.32, 0.30, 0.28, 0.26, 0.22, 0.18, 0.14, 0.08)  # m/s: bubbling, then throttled
BUBBLING, SETTLING = 0.3, 0.1  # s, at the first velocity and at each other
PACKED, STEADY = 0.9, 0.01  # a bed is packed if its pressure drop is a smaller share of its weight, and does not change
BULK = slice(1, 8)  # layers of cells that are deep in the bed and off the distributor at any velocity that packs it
SOLID = 2500.0  # kg/m3


def throttle(program, folder, *options):
    """Run the bed at each velocity in turn and return what was measured at each."""
    stages = [(velocity, SETTLING if number else BUBBLING) for number, velocity in enumerate(VELOCITIES)]
    return step_through(HERE, program, folder, stages, measure, options)


def measure(folder, velocity):
    """Pressure drop over weight, the gas's own weight taken off, and void fraction of the bulk; the later half of a run."""
    run = Run(folder)
    times = run.series["time"]
    half = (times[0] + times[-1]) / 2
    late = times > half
    gas_weight = DENSITY * GRAVITY * (run.gas.upper[1] - run.gas.lower[1])
    ratio = (run.series["pressure_drop"][late] - gas_weight) / run.series["weight_per_area"][late]
    frames = [s for s in range(run.gas.count) if run.gas.times[s] > half]
    eps = np.mean([run.gas("void_fraction", s)[:, BULK, :].mean() for s in frames])
    powder = run.parcels(-1)
    return SimpleNamespace(velocity=velocity, ratio=ratio.mean(), packed=ratio.mean() < PACKED and ratio.std() < STEADY,
                           eps=eps, powder=(powder["diameter"], powder["weight"]))


def find_umf(points):
    """Umf, the void fraction to which the bed has settled there, and what the drag law makes of it."""
    packed = [p for p in points if p.packed]
    u, y, eps = (np.array([getattr(p, name) for p in packed]) for name in ("velocity", "ratio", "eps"))
    umf, a, b = crossing(u, y)
    settled = np.polyval(np.polyfit(u, eps, 1), umf)
    return SimpleNamespace(umf=umf, eps=settled, law=carrying_velocity(settled, points[0].powder, SOLID), a=a, b=b)


def summary(found):
    """Means over the seeds of one weighting, and the standard error of that of Umf."""
    umf, eps, law = (np.array([getattr(f, name) for f in found]) for name in ("umf", "eps", "law"))
    return SimpleNamespace(umf=umf.mean(), error=umf.std(ddof=1) / np.sqrt(len(umf)), eps=eps.mean(), law=law.mean())


def write_table(program, points, means):
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    with open(HERE / "umf.csv", "w", newline="") as file:
        file.write(f"# {version}; cases/minimum_fluidization/validate.py; seeds {', '.join(map(str, SEEDS))}\n")
        for w, mean in means.items():
            file.write(f"# {w}: Umf {mean.umf:.4f} +- {mean.error:.4f} m/s; settled void fraction {mean.eps:.4f}, "
                       f"at which the drag law says {mean.law:.4f} m/s\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["weighting", "seed", "velocity_m_s", "pressure_drop_over_weight", "void_fraction"])
        for (w, seed), line in points.items():
            writer.writerows([w, seed, p.velocity, f"{p.ratio:.4f}", f"{p.eps:.4f}"] for p in line)


def draw(points, found, means):
    figure, (upper, lower) = plt.subplots(2, 1, figsize=(6, 7), sharex=True, height_ratios=(2, 1))
    for w, colour in zip(WEIGHTINGS, ("C0", "C1")):
        lines = [points[w, seed] for seed in SEEDS]
        u = [p.velocity for p in lines[0]]
        name = f"{w.upper()}: Umf {means[w].umf:.3f} m/s, drag law {means[w].law:.3f}"
        upper.plot(u, np.mean([[p.ratio for p in line] for line in lines], axis=0), "o", color=colour, label=name)
        a, b = (np.mean([getattr(f, c) for f in found[w]]) for c in "ab")
        fit = np.linspace(0, means[w].umf, 50)
        upper.plot(fit, a * fit + b * fit**2, color=colour, linewidth=1)
        upper.axvline(means[w].law, color=colour, linestyle=":")
        lower.plot(u, np.mean([[p.eps for p in line] for line in lines], axis=0), "o-", color=colour, linewidth=1)
    upper.axhline(1, color="grey", linewidth=0.8)
    upper.set_ylabel("pressure drop over bed weight per area")
    upper.set_title("dotted: where the drag law carries the settled bed", fontsize=9)
    upper.legend()
    lower.set_ylabel("void fraction of the bulk")
    lower.set_xlabel("superficial gas velocity [m/s]")
    figure.tight_layout()
    figure.savefig(HERE / "umf.png", dpi=90)


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "build/geldart")
    keys = [(w, seed) for w in WEIGHTINGS for seed in SEEDS]
    with ThreadPoolExecutor(os.cpu_count()) as cores:
        lines = cores.map(lambda name: throttle(program, HERE / "results" / name, *VARIANTS[name]), VARIANTS)
        points = dict(zip(keys, lines))
    found = {w: [find_umf(points[w, seed]) for seed in SEEDS] for w in WEIGHTINGS}
    means = {w: summary(found[w]) for w in WEIGHTINGS}
    write_table(program, points, means)
    draw(points, found, means)
    failed = 0

    def check(what, value, low, high):
        nonlocal failed
        failed += not low <= value <= high
        print(f"  {'ok  ' if low <= value <= high else 'FAIL'}  {what:58} {value:7.4f}   ({low:g} to {high:g})")

    for w, mean in means.items():
        print(f"{w.upper()}: Umf {mean.umf:.4f} +- {mean.error:.4f} m/s; the drag law at the settled void fraction, "
              f"{mean.eps:.4f}: {mean.law:.4f} m/s")
        check("Umf over that of the drag law", mean.umf / mean.law, 0.85, 1.15)
        check("pressure drop over weight, bubbling", np.mean([points[w, s][0].ratio for s in SEEDS]), 0.95, 1.05)
    ssp, ssw = means["ssp"], means["ssw"]
    check("Umf of SSP over that of SSW", ssp.umf / ssw.umf, 0.95, 1.05)
    check("at the same void fraction, by the drag law", ssp.umf / ssp.law * ssw.law / ssw.umf, 0.95, 1.05)
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()

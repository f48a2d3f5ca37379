"""Angle of repose of heaps with different friction: usage: validate.py [PROGRAM]

Runs the program itself and writes results/, repose.csv and repose.png beside this file. Exits with 1 where something is
not as README.md says it must be.
"""

import sys
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import bulk  # noqa: E402
from results import Parcels  # noqa: E402

FRICTIONS, SEEDS = (0.1, 0.2, 0.4, 0.8), (1, 2)
DIAMETER, DISH = 1.5e-3, 0.016
RINGS = np.arange(2, 10) * DIAMETER  # edges, from beside the top to one diameter within the rim
SECTORS = 12
RUNS = {(mu, seed): f"friction_{mu:g}_seed_{seed}" for mu in FRICTIONS for seed in SEEDS}
VARIANTS = {name: [f"contact%friction={mu}", f"parcels%seed={seed}"] for (mu, seed), name in RUNS.items()}


def profile(position):
    """Of each sector, the height of the highest parcel in each ring."""
    radius = np.hypot(position[:, 0], position[:, 2])
    angle = np.arctan2(position[:, 2], position[:, 0])
    sector = ((angle + np.pi) / (2 * np.pi) * SECTORS).astype(int) % SECTORS
    ring = np.digitize(radius, RINGS) - 1
    heights = np.full((SECTORS, len(RINGS) - 1), np.nan)
    for s, r in np.ndindex(heights.shape):
        inside = position[(sector == s) & (ring == r), 1]
        if len(inside):
            heights[s, r] = inside.max()
    return heights


def slope(heights):
    """Angle of the line through the mean profile, and its standard error from the sectors [degrees]."""
    middle = (RINGS[1:] + RINGS[:-1]) / 2
    angles = [-np.polyfit(middle[here], row[here], 1)[0] for row in heights if (here := np.isfinite(row)).sum() > 2]
    mean = -np.polyfit(middle, np.nanmean(heights, axis=0), 1)[0]
    degrees = np.degrees(np.arctan(angles))
    return float(np.degrees(np.arctan(mean))), float(degrees.std(ddof=1) / np.sqrt(len(degrees)))


def main():
    folders = bulk.run_all(HERE, VARIANTS, bulk.program())
    figure, axes = plt.subplots(1, len(FRICTIONS) + 1, figsize=(11, 2.4), constrained_layout=True)
    rows, check = [], bulk.Checks()
    for (mu, seed), name in RUNS.items():
        last = Parcels(folders[name] / "parcels.vtkhdf")(-1)
        position = last["position"]
        on_dish = np.hypot(position[:, 0], position[:, 2]) < DISH
        angle, error = slope(profile(position[on_dish]))
        rows.append((mu, seed, angle, error, int(on_dish.sum())))
        check(f"friction {mu:g}, seed {seed}: angle of repose, degrees", angle, 0, 35)
        check("  its standard error", error, 0, 2)
        check("  speed on the dish, m/s", np.abs(last["velocity"][on_dish]).max(), 0, 0.05)
        check("  nothing is left in the funnel", (position[:, 1] > 0.0135).sum(), 0, 0)
        if seed == SEEDS[0]:
            axis, order = axes[FRICTIONS.index(mu)], np.argsort(position[:, 2])
            axis.scatter(*(1e3 * position[order, :2].T), s=9, c=position[order, 2], cmap="Blues", edgecolors="0.4", lw=0.2)
            axis.set(aspect="equal", xlim=(-22, 22), ylim=(0, 16), xlabel="mm", title=f"mu {mu:g}: {angle:.1f} degrees")
    angles = np.array([[row[2] for row in rows if row[0] == mu] for mu in FRICTIONS])
    mean = angles.mean(axis=1)
    check("growth of the mean from 0.1 to 0.2, degrees", mean[1] - mean[0], 1, 30)
    check("growth of the mean from 0.2 to 0.4, degrees", mean[2] - mean[1], 1, 30)
    check("change of the mean from 0.4 to 0.8, where it levels off, degrees", mean[3] - mean[2], -2, 3)
    header = ("friction", "seed", "angle_degrees", "standard_error_degrees", "parcels_on_dish")
    bulk.write_table(HERE / "repose.csv", header, rows, seeds=SEEDS)
    axes[-1].plot(FRICTIONS, mean, "-", color="#1f6fb4")
    axes[-1].plot(np.repeat(FRICTIONS, len(SEEDS)), angles.ravel(), "o", ms=4, mfc="none", color="#1f6fb4")
    axes[-1].set(xlabel="friction", ylabel="angle of repose, degrees", ylim=(0, None))
    figure.savefig(HERE / "repose.png", dpi=90, metadata={"Software": None})
    sys.exit(check.failed > 0)


if __name__ == "__main__":
    main()

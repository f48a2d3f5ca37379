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

FRICTIONS = (0.1, 0.2, 0.4, 0.8)
DIAMETER, DISH = 1.5e-3, 0.016
RINGS = np.arange(2, 10) * DIAMETER  # edges, from beside the top to one diameter within the rim
SECTORS = 12


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
    names = {mu: f"friction_{mu:g}" for mu in FRICTIONS}
    folders = bulk.run_all(HERE, {names[mu]: [f"contact%friction={mu}"] for mu in FRICTIONS}, bulk.program())
    figure, axes = plt.subplots(1, len(FRICTIONS) + 1, figsize=(11, 2.4), constrained_layout=True)
    rows, check = [], bulk.Checks()
    for mu, axis in zip(FRICTIONS, axes, strict=False):
        last = Parcels(folders[names[mu]] / "parcels.vtkhdf")(-1)
        position = last["position"]
        on_dish = np.hypot(position[:, 0], position[:, 2]) < DISH
        angle, error = slope(profile(position[on_dish]))
        rows.append((mu, angle, error, int(on_dish.sum())))
        order = np.argsort(position[:, 2])
        axis.scatter(*(1e3 * position[order, :2].T), s=9, c=position[order, 2], cmap="Blues", edgecolors="0.4", lw=0.2)
        axis.set(aspect="equal", xlim=(-22, 22), ylim=(0, 16), xlabel="mm", title=f"mu {mu:g}: {angle:.1f} degrees")
        check(f"friction {mu:g}: angle of repose, degrees", angle, 0, 35)
        check("  its standard error", error, 0, 2)
        check("  speed on the dish, m/s", np.abs(last["velocity"][on_dish]).max(), 0, 0.05)
        check("  nothing is left in the funnel", (position[:, 1] > 0.0135).sum(), 0, 0)
    angles = [row[1] for row in rows]
    check("smallest growth from one friction to the next, degrees", min(np.diff(angles)), 0, 90)
    check("growth from the least to the highest friction, degrees", angles[-1] - angles[0], 4, 30)
    bulk.write_table(HERE / "repose.csv", ("friction", "angle_degrees", "standard_error_degrees", "parcels_on_dish"), rows)
    axes[-1].errorbar(FRICTIONS, angles, [row[2] for row in rows], fmt="o-", color="#1f6fb4", capsize=2)
    axes[-1].set(xlabel="friction", ylabel="angle of repose, degrees", ylim=(0, None))
    figure.savefig(HERE / "repose.png", dpi=90, metadata={"Software": None})
    sys.exit(check.failed > 0)


if __name__ == "__main__":
    main()

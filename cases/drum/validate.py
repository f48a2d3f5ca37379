"""Dynamic angle of repose in a rotating drum from rolling to the centrifuge: usage: validate.py [PROGRAM]

Runs the program itself and writes results/, drum.csv and drum.png beside this file. Exits with 1 where something is
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

FROUDE = (0.002, 0.01, 0.04, 0.15, 1.5)  # omega^2 R/g
DIAMETER, RADIUS, GRAVITY, START = 2e-3, 0.03, 9.81, 1.0  # m, m, m/s2, s from which on means are taken
CELL = 1e-3
SPEEDS = {froude: float(np.sqrt(froude * GRAVITY / RADIUS)) for froude in FROUDE}  # rad/s
VARIANTS = {f"froude_{froude:g}": [f"wall({wall})%angular_velocity=0, 0, {speed:.6g}" for wall in ("drum", "front", "back")]
            for froude, speed in SPEEDS.items()}


def density(parcels):
    """Parcels per cell and frame in the mean from START on: (y, x)."""
    edges = np.arange(-RADIUS, RADIUS + CELL / 2, CELL)
    frames = [step for step in range(parcels.count) if parcels.times[step] >= START]
    total = 0
    for step in frames:
        position = parcels(step)["position"]
        total = total + np.histogram2d(position[:, 1], position[:, 0], bins=(edges, edges))[0]
    return (edges[1:] + edges[:-1]) / 2, total / len(frames)


def surface(middle, field):
    """Height in each column up to which the mean density is over half that of the bulk, interpolated [m]."""
    smooth = field.copy()
    smooth[1:-1] = (field[2:] + field[1:-1] + field[:-2]) / 3  # over a layer of parcels
    half = np.median(smooth[smooth > 0.2 * smooth.max()]) / 2
    height = np.full(len(middle), np.nan)
    for column, values in enumerate(smooth.T):
        dense = np.nonzero(values > half)[0]
        if len(dense) and dense[-1] + 1 < len(middle):
            top = dense[-1]
            height[column] = middle[top] + CELL * (values[top] - half) / (values[top] - values[top + 1])
    return height


def angle(middle, height):
    """Of the line through the middle half of the surface [degrees]."""
    inner = (np.abs(middle) < RADIUS / 2) & np.isfinite(height)
    return float(np.degrees(np.arctan(np.polyfit(middle[inner], height[inner], 1)[0])))


def covered(middle, field):
    """Share of the wall that is covered by parcels."""
    x, y = np.meshgrid(middle, middle)
    radius, turn = np.hypot(x, y), np.arctan2(y, x)
    near = (radius > RADIUS - 1.2 * DIAMETER) & (radius < RADIUS)
    sector = ((turn + np.pi) / (2 * np.pi) * 36).astype(int) % 36
    load = np.array([field[near & (sector == s)].mean() for s in range(36)])
    return float((load > 0.4 * np.sort(load)[-9]).mean())


def main():
    folders = bulk.run_all(HERE, VARIANTS, bulk.program())
    figure, axes = plt.subplots(1, len(FROUDE) + 1, figsize=(13, 2.5), constrained_layout=True)
    rows, check = [], bulk.Checks()
    for froude, axis in zip(FROUDE, axes, strict=False):
        parcels = Parcels(folders[f"froude_{froude:g}"] / "parcels.vtkhdf")
        middle, field = density(parcels)
        height = surface(middle, field)
        share = covered(middle, field)
        slope = angle(middle, height) if share < 0.9 else np.nan
        rows.append((froude, SPEEDS[froude], slope, share))
        position = parcels(-1)["position"]
        axis.scatter(*(1e3 * position[:, :2].T), s=3, color="#1f6fb4", lw=0)
        if np.isfinite(slope):
            axis.plot(1e3 * middle, 1e3 * height, color="#d1762b", lw=1)
        axis.add_patch(plt.Circle((0, 0), 1e3 * RADIUS, fill=False, color="0.25", lw=0.8))
        axis.set(aspect="equal", xlim=(-31, 31), ylim=(-31, 31))
        axis.set_title(f"Fr {froude:g}" + (f": {slope:.0f}°" if share < 0.9 else ""))
        axis.set_axis_off()
    angles = [row[2] for row in rows]
    for froude, value in zip(FROUDE[:2], angles, strict=False):
        check(f"Fr {froude:g}: dynamic angle of repose, degrees", value, 20, 40)
    check("smallest growth from one speed to the next, degrees", min(np.diff(angles[:4])), 0, 90)
    check("growth from Fr 0.002 to 0.15, degrees", angles[3] - angles[0], 4, 40)
    for froude, row in zip(FROUDE[:3], rows, strict=False):
        check(f"Fr {froude:g}: share of the wall that is covered", row[3], 0.25, 0.6)
    check(f"Fr {FROUDE[-1]:g}: the same, a centrifuge", rows[-1][3], 0.95, 1)
    bulk.write_table(HERE / "drum.csv", ("froude", "speed_rad_s", "angle_degrees", "wall_covered"), rows)
    axes[-1].semilogx(FROUDE, angles, "o-", color="#1f6fb4")
    axes[-1].set(xlabel="Fr", ylabel="degrees")
    figure.savefig(HERE / "drum.png", dpi=90, metadata={"Software": None})
    sys.exit(check.failed > 0)


if __name__ == "__main__":
    main()

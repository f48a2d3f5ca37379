"""Solids fraction of beds poured with different friction: usage: validate.py [PROGRAM]

Runs the program itself and writes results/, packing.csv and packing.png beside this file. Exits with 1 where something is
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

FRICTIONS = (0, 0.1, 0.2, 0.4, 0.8)
NAMES = {mu: f"friction_{mu:g}" for mu in FRICTIONS}
VARIANTS = {NAMES[mu]: [f"contact%friction={mu}"] for mu in FRICTIONS}
DIAMETER, AREA = 1e-3, 0.012**2
FLOOR, SURFACE = 5, 4  # diameters left out at the floor, which orders its layers, and below the top


def volume_below(height, z, d):
    """Of spheres with centres at `height`, what lies below a plane z."""
    h = np.clip(z - height + d / 2, 0, d)
    return (np.pi * h**2 * (1.5 * d - h) / 3).sum()


def fraction(height, low, high):
    return (volume_below(height, high, DIAMETER) - volume_below(height, low, DIAMETER)) / (AREA * (high - low))


def main():
    folders = bulk.run_all(HERE, VARIANTS, bulk.program())
    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.2), constrained_layout=True)
    rows, check = [], bulk.Checks()
    for mu in FRICTIONS:
        last = Parcels(folders[NAMES[mu]] / "parcels.vtkhdf")(-1)
        height = last["position"][:, 1]
        top = np.percentile(height, 98)
        speed = float(np.sqrt((last["velocity"] ** 2).sum(axis=1).mean()))
        rows.append((mu, fraction(height, FLOOR * DIAMETER, top - SURFACE * DIAMETER), speed))
        planes = np.arange(0, top, DIAMETER / 4)
        layers = [fraction(height, z - DIAMETER / 2, z + DIAMETER / 2) for z in planes]
        left.plot(1e3 * planes, layers, lw=1, label=f"mu {mu:g}")
        check(f"friction {mu:g}: solids fraction", rows[-1][1], 0.555, 0.645)
        check("  root mean square speed, m/s", rows[-1][2], 0, 0.01)
    found = [row[1] for row in rows]
    check("smallest fall of the solids fraction from one friction to the next", -max(np.diff(found)), 0, 1)
    check("solids fraction without friction", found[0], 0.62, 0.645)
    check("and with the highest", found[-1], 0.58, 0.61)
    bulk.write_table(HERE / "packing.csv", ("friction", "solids_fraction", "rms_speed_m_s"), rows)
    left.set(xlabel="height, mm", ylabel="solids fraction of layers", ylim=(0, 0.8))
    left.legend(fontsize=7)
    right.axhspan(0.58, 0.64, color="0.93")
    right.axhline(0.6366, color="0.25", lw=0.8, ls=":", label="random close packing")
    right.axhline(0.555, color="0.25", lw=0.8, ls="--", label="random loose packing")
    right.plot(FRICTIONS, found, "o-", color="#1f6fb4", label="geldart")
    right.set(xlabel="friction", ylim=(0.54, 0.66))
    right.legend(fontsize=7)
    figure.savefig(HERE / "packing.png", dpi=90, metadata={"Software": None})
    sys.exit(check.failed > 0)


if __name__ == "__main__":
    main()

"""Discharge of a flat-bottomed hopper through holes of different widths against Beverloo's law: usage: validate.py [PROGRAM]

Runs the program itself and writes results/, discharge.csv and discharge.png beside this file. Exits with 1 where
something is not as README.md says it must be.
"""

import sys
from pathlib import Path

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import bulk  # noqa: E402
from results import Parcels  # noqa: E402

HOLES = (0.005, 0.006, 0.007, 0.008)  # m
NAMES = {hole: f"hole_{1e3 * hole:g}mm" for hole in HOLES}
VARIANTS = {NAMES[hole]: [f"wall(bottom)%radius={hole / 2}"] for hole in HOLES}
DIAMETER, DENSITY, VESSEL, GRAVITY = 1e-3, 2500.0, 0.0112, 9.81
EXPERIMENTS = ((0.55, 1.6), (0.65, 1.2))  # C and k with the least and the largest flow
SETTLED, SHALLOW = 0.2, 4200  # s until the bed has come down; parcels whose bed is less deep than the widest hole


def bulk_density(position, low=0.007, high=0.012):
    """Of the bed between two heights, spheres cut by the planes [kg/m3]."""
    height = position[:, 1]

    def below(z):
        h = np.clip(z - height + DIAMETER / 2, 0, DIAMETER)
        return (np.pi * h**2 * (1.5 * DIAMETER - h) / 3).sum()

    return DENSITY * (below(high) - below(low)) / (np.pi * VESSEL**2 * (high - low))


def discharge(folder):
    """Times, parcels in the vessel, the steady part of them, the mass flow out of it [kg/s], the bulk density [kg/m3]."""
    with h5py.File(folder / "monitor.h5") as file:
        time, count, mass = (file["series"][name][()] for name in ("time", "parcels", "parcel_mass"))
    steady = (time > SETTLED) & (count > SHALLOW)
    parcels = Parcels(folder / "parcels.vtkhdf")
    frame = parcels(int(np.argmin(np.abs(parcels.times - SETTLED))))
    return time, count, steady, -np.polyfit(time[steady], mass[steady], 1)[0], bulk_density(frame["position"])


def beverloo(hole, c, k, density):
    """Mass flow through a hole [kg/s]. Beverloo, Leniger & van de Velde, Chem. Eng. Sci. 15 (1961) 260-269."""
    return c * density * np.sqrt(GRAVITY) * (hole - k * DIAMETER) ** 2.5


def main():
    folders = bulk.run_all(HERE, VARIANTS, bulk.program())
    figure, (left, right, picture) = plt.subplots(1, 3, figsize=(11, 3.2), constrained_layout=True)
    found, check = {}, bulk.Checks()
    for hole in HOLES:
        time, count, steady, flow, density = found[hole] = discharge(folders[NAMES[hole]])
        line = np.polyfit(time[steady], count[steady], 1)
        check(f"hole of {1e3 * hole:g} mm: parcels in the steady part", count[steady][0] - count[steady][-1], 400, 1e4)
        uneven = np.abs(count[steady] - np.polyval(line, time[steady])).max()
        check("  largest distance from a steady flow over what has left", uneven / (count[steady][0] - count[steady][-1]), 0, 0.03)
        left.plot(time, count, lw=1.2, label=f"{1e3 * hole:g} mm")
        left.plot(time[steady], np.polyval(line, time[steady]), ":", color="0.25", lw=1)
    flows, density = np.array([found[h][3] for h in HOLES]), np.mean([found[h][4] for h in HOLES])
    holes = np.array(HOLES)
    slope, offset = np.polyfit(holes, flows**0.4, 1)
    c, k = slope**2.5 / (density * np.sqrt(GRAVITY)), -offset / slope / DIAMETER
    fitted = beverloo(holes, c, k, density)
    print(f"  fitted C {c:.3f} (experiments: 0.55 to 0.65), k {k:.2f} (1.2 to 1.6)")
    for hole, flow in zip(HOLES, flows, strict=True):
        low, high = (beverloo(hole, *pair, density) for pair in EXPERIMENTS)
        check(f"hole of {1e3 * hole:g} mm: mass flow, g/s, within that of experiments", 1e3 * flow, 1e3 * low, 1e3 * high)
    check("largest distance from the fit", np.abs(flows / fitted - 1).max(), 0, 0.05)
    check("solids fraction of the bed", density / DENSITY, 0.55, 0.62)
    bulk.write_table(HERE / "discharge.csv", ("hole_m", "mass_flow_kg_s", "fit_kg_s", "bulk_density_kg_m3"),
                     [(h, float(f), float(b), float(found[h][4])) for h, f, b in zip(HOLES, flows, fitted, strict=True)],
                     f"W = C rho_b sqrt(g) (D - k d)^2.5: C {c:.3f}, k {k:.2f}, rho_b {density:.0f} kg/m3")
    left.axhline(SHALLOW, color="0.6", lw=0.8)
    left.set(xlabel="time, s", ylabel="parcels in the vessel")
    left.legend(fontsize=7)
    x = np.linspace(0.0035, 0.009, 50)
    right.fill_between(1e3 * x, *(1e3 * beverloo(x, *pair, density) for pair in EXPERIMENTS), color="0.92",
                       label="C 0.55 to 0.65, k 1.2 to 1.6")
    right.plot(1e3 * x, 1e3 * beverloo(x, c, k, density), color="0.25", lw=0.8, label=f"fit: C {c:.3f}, k {k:.2f}")
    right.plot(1e3 * holes, 1e3 * flows, "o", color="#1f6fb4", label="geldart")
    right.set(xlabel="hole, mm", ylabel="mass flow, g/s")
    right.legend(fontsize=7)
    parcels = Parcels(folders[NAMES[0.006]] / "parcels.vtkhdf")
    frame = parcels(int(np.argmin(np.abs(parcels.times - 0.35))))
    slice_ = np.abs(frame["position"][:, 2]) < DIAMETER
    down = -frame["velocity"][slice_, 1]
    dots = picture.scatter(*(1e3 * frame["position"][slice_, :2].T), s=10, c=down, cmap="viridis", vmin=0, vmax=0.3)
    figure.colorbar(dots, ax=picture, label="downward, m/s")
    picture.set(aspect="equal", xlabel="mm", title="6 mm, 0.35 s, middle slice")
    figure.savefig(HERE / "discharge.png", dpi=90, metadata={"Software": None})
    sys.exit(check.failed > 0)


if __name__ == "__main__":
    main()

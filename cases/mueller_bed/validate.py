"""Time-mean void fraction of a bed of poppy seeds beside that measured: usage: validate.py [PROGRAM | --read]

Runs the program itself, once with each drag law, and writes results/, profiles.csv and profiles.png beside this file; with
--read the results that are there are looked at again. Exits with 1 where something is not as README.md says it must be.
"""

import csv
import sys
from pathlib import Path
from types import SimpleNamespace

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import bulk  # noqa: E402
from fluidization import DENSITY, GRAVITY  # noqa: E402
from results import Run, mean_with_error  # noqa: E402

LAWS = {"gidaspow": "#1f6fb4", "beetstra": "#c8502d"}
VARIANTS = {law: [f"coupling%drag={law}"] for law in LAWS}
HEIGHTS = (16.4, 31.2)  # mm
START, END = 1.0, 17.0  # s: the bed has forgotten how it began; the run ends
SHOWN = 3.0  # s: the instant that is drawn


def reference(origin, height):
    """x [mm] and void fraction of one profile of reference.csv."""
    with (HERE / "reference.csv").open() as file:
        rows = [row for row in csv.DictReader(line for line in file if not line.startswith("#")) if row["origin"] == origin]
    rows = [row for row in rows if float(row["height_mm"]) == height]
    return np.array([[float(row["x_mm"]), float(row["void_fraction"])] for row in rows]).T


def distance(x, profile, points):
    """Root mean square and mean of a profile less points (x, value), where the profile is known."""
    inside = (points[0] >= x[0]) & (points[0] <= x[-1])
    off = np.interp(points[0][inside], x, profile) - points[1][inside]
    return np.sqrt(np.mean(off**2)), np.mean(off)


def examine(folder):
    """Depth-averaged void fraction at the two heights: mean and standard error of each place; and of the bed as a whole."""
    run = Run(folder)
    gas, series = run.gas, run.series
    frames = [step for step in range(gas.count) if START <= gas.times[step] <= END]
    eps = np.array([gas("void_fraction", step).mean(axis=0) for step in frames])  # (time, y, x)
    y, profiles = 1e3 * gas.centres(1), {}
    for height in HEIGHTS:
        below = int(np.searchsorted(y, height)) - 1
        share = (height - y[below]) / (y[below + 1] - y[below])
        history = (1 - share) * eps[:, below] + share * eps[:, below + 1]
        profiles[height] = np.array([mean_with_error(place) for place in history.T]).T
    late = (series["time"] >= START) & (series["time"] <= END)
    gas_weight = DENSITY * GRAVITY * (gas.upper[1] - gas.lower[1])
    ratio = (series["pressure_drop"] - gas_weight) / series["weight_per_area"]
    return SimpleNamespace(run=run, x=1e3 * gas.centres(0), profiles=profiles, mean=eps.mean(axis=0), ratio=ratio,
                           drop=mean_with_error(ratio[late]), height=mean_with_error(series["bed_height"][late]),
                           window=gas.times[frames[-1]] - gas.times[frames[0]], late=late)


def check_bed(law, found, check):
    """What holds whatever the drag law."""
    series = found.run.series
    print(f"{law}: averaged over {found.window:.1f} s; height of 95 % of the mass {1e3 * found.height[0]:.1f} "
          f"+- {1e3 * found.height[1]:.1f} mm")
    check("parcels gone or lost", float(np.max(abs(series["parcels"] - series["parcels"][0]) + series["parcels_lost"])), 0, 0)
    check("mass at the end over that at the start", series["parcel_mass"][-1] / series["parcel_mass"][0], 1 - 1e-9, 1 + 1e-9)
    check("pressure drop over weight per area", found.drop[0], 0.95, 1.05)
    check("  its standard error", found.drop[1], 0, 0.02)
    check("largest overlap over radius", np.nanmax(series["max_overlap"]), 0, 0.1)
    check("gas mass imbalance over inflow, largest", np.nanmax(series["mass_imbalance"]), 0, 1e-6)
    check("momentum given against taken, largest difference", np.nanmax(series["exchange_residual"]), 0, 1e-12)


def check_profiles(found, check):
    """Distance from the experiment, and how well the means are known; remarks for the table."""
    remarks = []
    for height in HEIGHTS:
        mean, error = found.profiles[height]
        measured, simulated = reference("experiment", height), reference("simulation", height)
        (rms, offset), (other, _) = distance(found.x, mean, measured), distance(*simulated, measured)
        error = np.sqrt(np.mean(error**2))
        middle, rim = mean[len(mean) // 3 : -(len(mean) // 3)].mean(), np.concatenate([mean[:2], mean[-2:]]).mean()
        check(f"{height} mm: standard error of the mean, rms", error, 0, 0.02)
        check(f"{height} mm: distance from the experiment, rms", rms, 0, other + 0.01)
        check(f"{height} mm: middle less walls", middle - rim, 0.03, 0.4)
        remarks.append(f"{height} mm: rms distance from the experiment {rms:.3f}, mean {offset:+.3f}, standard error {error:.3f}; "
                       f"the simulation of reference.csv {other:.3f}")
    return remarks


def draw_bed(axes, found, law):
    """Mean void fraction and an instant of the bed."""
    gas, parcels = found.run.gas, found.run.parcels
    extent = [1e3 * v for v in (gas.lower[0], gas.upper[0], gas.lower[1], gas.upper[1])]
    step = int(np.argmin(abs(parcels.times - SHOWN)))
    near = int(np.argmin(abs(gas.times - parcels.times[step])))
    place = parcels(step)["position"]
    slice_ = abs(place[:, 2] - (gas.lower[2] + gas.upper[2]) / 2) < 1.2e-3
    axes[0].imshow(found.mean, origin="lower", extent=extent, vmin=0.35, vmax=1, cmap="magma")
    axes[0].set_title(f"{law}, mean", fontsize=9)
    image = axes[1].imshow(gas("void_fraction", near).mean(axis=0), origin="lower", extent=extent, vmin=0.35, vmax=1, cmap="magma")
    axes[1].set_title(f"{parcels.times[step]:g} s, void fraction", fontsize=9)
    axes[2].scatter(*(1e3 * place[slice_, :2].T), s=5, color=LAWS[law])
    axes[2].set_title(f"{parcels.times[step]:g} s, middle slice", fontsize=9)
    for ax in axes:
        ax.set(xlim=extent[:2], ylim=(0, 80), aspect="equal")
    for height in HEIGHTS:
        axes[0].axhline(height, color="w", lw=0.6, ls=":")
    return image


def draw(found):
    figure = plt.figure(figsize=(12, 7), constrained_layout=True)
    upper, lower = figure.subfigures(2, 1)
    panels = upper.subplots(1, 3)
    for ax, height in zip(panels, HEIGHTS):
        ax.plot(*reference("experiment", height), "ko", ms=4, label="experiment")
        ax.plot(*reference("simulation", height), "x", color="0.5", ms=5, label="simulation of others")
        for law, bed in found.items():
            mean, error = bed.profiles[height]
            ax.errorbar(bed.x, mean, error, color=LAWS[law], lw=1.2, capsize=2, label=law)
        ax.set(title=f"{height} mm above the distributor", xlabel="x, mm", ylabel="time-mean void fraction", ylim=(0.35, 0.85))
        ax.legend(fontsize=8)
    for law, bed in found.items():
        panels[2].plot(bed.run.series["time"], bed.ratio, color=LAWS[law], lw=0.5, label=f"{law}: mean {bed.drop[0]:.3f}")
    panels[2].axhline(1, color="k", lw=0.8, ls="--")
    panels[2].set(xlabel="time, s", ylabel="pressure drop over weight", ylim=(0, 2.5))
    panels[2].legend(fontsize=8)
    axes = lower.subplots(1, 3 * len(found))
    for number, (law, bed) in enumerate(found.items()):
        image = draw_bed(axes[3 * number : 3 * number + 3], bed, law)
    lower.colorbar(image, ax=axes, label="void fraction", shrink=0.8)
    figure.savefig(HERE / "profiles.png", dpi=90, metadata={"Software": None})


def main():
    again = sys.argv[1:] == ["--read"]
    folders = {law: HERE / "results" / law for law in LAWS}
    if not again:
        folders = bulk.run_all(HERE, VARIANTS, bulk.program())
    found, check = {law: examine(folder) for law, folder in folders.items()}, bulk.Checks()
    remarks, rows = [], []
    for law, bed in found.items():
        check_bed(law, bed, check)
        remarks += [f"{law}, {bed.window:.1f} s, {line}" for line in check_profiles(bed, check)]
        remarks.append(f"{law}: pressure drop over weight {bed.drop[0]:.3f} +- {bed.drop[1]:.3f}")
        rows += [(law, height, float(x), float(mean), float(error)) for height in HEIGHTS
                 for x, mean, error in zip(bed.x, *bed.profiles[height], strict=True)]
    bulk.write_table(HERE / "profiles.csv", ("drag", "height_mm", "x_mm", "void_fraction", "standard_error"), rows, *remarks,
                     results=folders["gidaspow"])
    draw(found)
    sys.exit(check.failed > 0)


if __name__ == "__main__":
    main()

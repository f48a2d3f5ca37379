"""Runs the bed at rising gas velocities and finds its minimum fluidization velocity, as SSP and as SSW.

usage: validate.py [PROGRAM [RANKS]]        writes results/, umf.csv and umf.png beside this file

Umf is where the pressure drop of the packed bed, a U + b U^2 through the velocities that do not lift it, reaches
the weight of the bed. It must lie within 15 % of the velocity at which the drag law itself carries the powder at
the void fraction of the settled bed, and be the same for SSP and SSW within 5 %.
"""

import csv
import subprocess
import sys
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from results import Run  # noqa: E402

VELOCITIES = [0.04, 0.08, 0.12, 0.16, 0.20, 0.24, 0.28, 0.34, 0.40]  # m/s
DENSITY, VISCOSITY, SOLID, GRAVITY = 1.2, 1.8e-5, 2500.0, 9.81


def compute(program, ranks, weighting, velocity):
    """Run one velocity and return the folder of its results."""
    folder = HERE / "results" / f"{weighting}_{velocity:.2f}"
    subprocess.run(["sh", str(HERE.parents[1] / "src/build/launch.sh"), str(ranks), program, str(HERE / "case.nml"),
                    "--force", "--out", str(folder), "--set", f"parcels%weighting='{weighting}'",
                    "--set", f"boundary(distributor)%velocity={velocity}"], check=True, stdout=subprocess.DEVNULL)
    return folder


def measure(folder):
    """Pressure drop over weight, with the gas's own weight taken off, and void fraction of the bed's lower half."""
    run = Run(folder)
    late = run.series["time"] > 0.2
    gas_weight = DENSITY * GRAVITY * (run.gas.upper[1] - run.gas.lower[1])
    ratio = (run.series["pressure_drop"][late] - gas_weight) / run.series["weight_per_area"][late]
    half = run.series["mean_height"][late].mean()
    layers = run.gas.centres(1) < half
    eps = np.mean([run.gas("void_fraction", s)[:, layers, :].mean() for s in range(run.gas.count) if run.gas.times[s] > 0.2])
    return ratio.mean(), eps, run.parcels(-1)


def gidaspow(reynolds, eps):
    """Drag over Stokes drag at the superficial slip. Ergun below a void fraction of 0.8, where a bed is."""
    return (150 * (1 - eps) + 1.75 * reynolds) / (18 * eps**2)


def carried(velocity, eps, diameter, weight):
    """Drag of real particles over their weight less buoyancy, at a superficial velocity."""
    reynolds = DENSITY * velocity * diameter / VISCOSITY
    slip = velocity / eps
    drag = 3 * np.pi * VISCOSITY * diameter * eps * gidaspow(reynolds, eps) * slip
    volume = np.pi / 6 * diameter**3
    # The pressure gradient, the weight of the whole bed, carries the share 1 - eps of it; drag carries the rest.
    return np.sum(weight * drag) / np.sum(weight * volume * (SOLID - DENSITY) * GRAVITY * eps)


def drag_law_umf(eps, parcels):
    """Velocity at which the drag law carries the parcels' powder at a void fraction [m/s]."""
    low, high = 1e-4, 5.0
    for _ in range(60):
        middle = (low + high) / 2
        if carried(middle, eps, parcels["diameter"], parcels["weight"]) < 1:
            low = middle
        else:
            high = middle
    return low


def measured_umf(velocities, ratios):
    """Where the curve of the packed bed meets the bed's weight [m/s]."""
    packed = np.asarray(ratios) < 0.9
    u, y = np.asarray(velocities)[packed], np.asarray(ratios)[packed]
    (a, b), *_ = np.linalg.lstsq(np.stack([u, u**2], axis=1), y, rcond=None)
    return (-a + np.sqrt(a**2 + 4 * b)) / (2 * b) if b > 0 else 1 / a


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else str(HERE.parents[1] / "build/geldart")
    ranks = sys.argv[2] if len(sys.argv) > 2 else 2
    rows, umf, expected, wrong = [], {}, {}, []
    for weighting in ("ssp", "ssw"):
        ratios, settled = [], []
        for velocity in VELOCITIES:
            ratio, eps, parcels = measure(compute(program, ranks, weighting, velocity))
            ratios.append(ratio)
            rows.append([weighting, velocity, f"{ratio:.4f}", f"{eps:.4f}"])
            if ratio < 0.9:
                settled.append(eps)
        umf[weighting] = measured_umf(VELOCITIES, ratios)
        expected[weighting] = drag_law_umf(np.mean(settled), parcels)
        print(f"{weighting}: Umf {umf[weighting]:.4f} m/s, the drag law at void fraction {np.mean(settled):.4f}: "
              f"{expected[weighting]:.4f} m/s")
        if abs(umf[weighting] / expected[weighting] - 1) > 0.15:
            wrong.append(f"{weighting}: Umf is not within 15 % of the drag law's")
        plt.plot(VELOCITIES, ratios, "o-", label=f"{weighting.upper()}, Umf {umf[weighting]:.3f} m/s")
        plt.axvline(expected[weighting], color=plt.gca().lines[-1].get_color(), linestyle=":")
    if abs(umf["ssp"] / umf["ssw"] - 1) > 0.05:
        wrong.append("Umf of SSP and SSW differ by more than 5 %")
    with open(HERE / "umf.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["# Umf [m/s] " + ", ".join(f"{w} {umf[w]:.4f} (drag law {expected[w]:.4f})" for w in umf)])
        writer.writerow(["weighting", "velocity_m_s", "pressure_drop_over_weight", "void_fraction"])
        writer.writerows(rows)
    plt.axhline(1, color="grey", linewidth=0.8)
    plt.xlabel("superficial gas velocity [m/s]")
    plt.ylabel("pressure drop over bed weight per area")
    plt.title("dotted: the drag law at the settled void fraction", fontsize=9)
    plt.legend()
    plt.savefig(HERE / "umf.png", dpi=110)
    for line in wrong:
        print("FAIL", line)
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()

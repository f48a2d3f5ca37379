"""A bed of fine powder from bubbling to packed, as SSP, as SSW and with cohesion: usage: validate.py [PROGRAM | --read]

The gas is turned up, then down step by step, each step continuing the one before. Runs the program itself, as many beds at
a time as there are cores, and writes results/, bed.csv and bed.png beside this file; with --read the results that are
there are looked at again. Exits with 1 where something is not as README.md says it must be.
"""

import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import bulk  # noqa: E402
from fluidization import DENSITY, GRAVITY, carrying_velocity, step_through  # noqa: E402
from results import Run  # noqa: E402

SOLID = 1500.0  # kg/m3
# (velocity [m/s], s): turned up, bubbling at 30 Umf, then down through expanded to packed
STAGES = ((0.03, 0.1), (0.06, 0.12), (0.11, 0.4), (0.03, 0.15), (0.0125, 0.2), (0.009, 0.2), (0.007, 0.2), (0.0055, 0.15),
          (0.0045, 0.15), (0.0035, 0.15), (0.003, 0.15), (0.0025, 0.15), (0.0015, 0.15))
BUBBLING, EXPANDED = 2, slice(5, 9)  # of the stages
PACKED = 0.68  # a bed is packed if its pressure drop is a smaller share of its weight; with more it begins to expand
COHESION = ("contact%cohesion=van_der_waals", "contact%hamaker_constant=2.1e-14", "contact%minimum_separation=2e-6",
            "contact%maximum_separation=20e-6", "contact%cohesion_scaling=bond_number")
VARIANTS = {"ssp": ("parcels%weighting=ssp",), "ssw": ("parcels%weighting=ssw",), "cohesive": ("parcels%weighting=ssp", *COHESION)}
COLOURS = {"ssp": "#1f6fb4", "ssw": "#c8502d", "cohesive": "#3c8c40"}


def bulk_of(run, step):
    """Of the layers within the bed: void fraction, its spread over the cells, velocity of the solids [m/s], their powder."""
    gas, parcels = run.gas, run.parcels(step)
    height = parcels["position"][:, 1]
    top = int(np.quantile(height, 0.95) / gas.h[1]) - 1  # two layers below the surface, one above the distributor
    eps = gas("void_fraction", step)[:, 1:top]
    within = (height > gas.h[1]) & (height < top * gas.h[1])
    diameter, weight, velocity = parcels["diameter"][within], parcels["weight"][within], parcels["velocity"][within, 1]
    return eps.mean(), eps.std(), np.average(velocity, weights=weight * diameter**3), (diameter, weight)


def measure(folder, velocity):
    """The later half of a stage: pressure drop over weight, the gas's own taken off; the bulk; how the coupling went."""
    run = Run(folder)
    series, gas = run.series, run.gas
    half = (series["time"][0] + series["time"][-1]) / 2
    late = series["time"] > half
    ratio = (series["pressure_drop"] - DENSITY * GRAVITY * (gas.upper[1] - gas.lower[1])) / series["weight_per_area"]
    eps, spread, falling, powders = zip(*(bulk_of(run, step) for step in range(gas.count) if gas.times[step] > half), strict=True)
    # The bed comes down for seconds where the gas is slow: drag is that of the gas relative to the solids.
    return SimpleNamespace(velocity=velocity, ratio=ratio[late].mean(), eps=np.mean(eps), spread=np.mean(spread),
                           slip=velocity - np.mean(falling), height=series["bed_height"][late].mean(), powder=powders[-1], run=run)


def find_umf(points):
    """Umf, the void fraction of the packed bed, and what the drag law makes of it with the powder in the bulk.

    Gas that slow is viscous: the pressure drop of a packed bed is a straight line, up to the weight of the bed at Umf.
    """
    packed = [p for p in points if p.ratio < PACKED]
    eps = np.mean([p.eps for p in packed])
    return SimpleNamespace(umf=1 / np.mean([p.ratio / p.slip for p in packed]), eps=eps, number=len(packed),
                           law=carrying_velocity(eps, packed[-1].powder, SOLID))


def check_coupling(points, check):
    """Fine powder follows the gas within a gas step: nothing may become stiff, or be hidden."""
    series = [p.run.series for p in points]

    def worst(name):
        return float(max(np.nanmax(s[name]) for s in series))

    check("parcels gone or lost", float(max(np.max(abs(s["parcels"] - series[0]["parcels"][0]) + s["parcels_lost"]) for s in series)), 0, 0)
    check("gas steps taken again", worst("gas_retries"), 0, 0)
    check("SIMPLE iterations of a gas step, most", worst("gas_iterations"), 1, 8)
    check("gas mass imbalance over inflow, largest", worst("mass_imbalance"), 0, 1e-6)
    check("momentum given against taken, largest difference", worst("exchange_residual"), 0, 1e-12)
    check("solids hidden by the limit of the void fraction", worst("clipped_volume"), 0, 0)
    check("largest overlap over radius", worst("max_overlap"), 0, 0.3)


def draw(beds, found):
    figure = plt.figure(figsize=(11, 8), constrained_layout=True)
    upper, lower = figure.subfigures(2, 1, height_ratios=(1, 0.9))
    left, right = upper.subplots(1, 2)
    for name, points in beds.items():
        u, umf = [p.velocity for p in points[BUBBLING:]], found[name]
        left.semilogx(u, [p.ratio for p in points[BUBBLING:]], "o-", ms=4, lw=0.8, color=COLOURS[name],
                      label=f"{name}: Umf {1e3 * umf.umf:.2f} mm/s, by the law {1e3 * umf.law:.2f}")
        down = points[BUBBLING + 2 :]
        right.loglog([p.eps for p in down], [p.slip for p in down], "o", ms=5, color=COLOURS[name], label=name)
    eps = np.linspace(0.4, 0.7, 40)
    whole = beds["ssp"][0].run.parcels(0)
    whole = (whole["diameter"], whole["weight"])
    right.loglog(eps, [carrying_velocity(e, whole, SOLID) for e in eps], "k", lw=0.8, label="this powder, gidaspow")
    table = np.genfromtxt(HERE / "reference.csv", delimiter=",", names=True, skip_header=1)
    for law, style in (("gidaspow", "k--"), ("wen_yu", "k:"), ("beetstra", "k-.")):
        inside = table["void_fraction"] < 0.71
        right.plot(table["void_fraction"][inside], table[law][inside], style, lw=0.8, label=f"75 um, {law}")
    left.axhline(1, color="grey", lw=0.8)
    left.set(xlabel="superficial gas velocity, m/s", ylabel="pressure drop over weight of the bed")
    right.set(xlabel="void fraction of the bulk", ylabel="gas less solids, superficial, m/s")
    ticks = (0.4, 0.45, 0.5, 0.55, 0.6, 0.7)
    right.set_xticks(ticks, [f"{t:g}" for t in ticks])
    slow = (0.002, 0.005, 0.01, 0.02, 0.04)
    right.set_yticks(slow, [f"{t:g}" for t in slow])
    right.minorticks_off()
    for ax in (left, right):
        ax.legend(fontsize=7)
    axes = lower.subplots(1, 9)
    for row, (name, points) in enumerate(beds.items()):
        for column, stage in enumerate((BUBBLING, 6, -1)):
            draw_instant(axes[3 * row + column], points[stage], name)
    figure.savefig(HERE / "bed.png", dpi=90, metadata={"Software": None})


def draw_instant(ax, point, name):
    gas, parcels = point.run.gas, point.run.parcels(-1)
    extent = [1e3 * v for v in (gas.lower[0], gas.upper[0], gas.lower[1], gas.upper[1])]
    ax.imshow(gas("void_fraction", -1).mean(axis=0), origin="lower", extent=extent, vmin=0.35, vmax=1, cmap="magma")
    slice_ = parcels["position"][:, 2] < 0.6e-3
    ax.plot(*(1e3 * parcels["position"][slice_, :2].T), ".", ms=1, color="w")
    ax.set(xlim=extent[:2], ylim=(0, 60), aspect="equal", xticks=(0, 10))
    ax.set_title(f"{name}\n{1e3 * point.velocity:g} mm/s", fontsize=8)


def main():
    program = None if sys.argv[1:] == ["--read"] else bulk.program()
    with ThreadPoolExecutor(os.cpu_count()) as cores:
        lines = cores.map(lambda name: step_through(HERE, program, HERE / "results" / name, STAGES, measure, VARIANTS[name]), VARIANTS)
        beds = dict(zip(VARIANTS, lines, strict=True))
    found, check = {name: find_umf(points) for name, points in beds.items()}, bulk.Checks()
    rows, remarks = [], []
    for name, points in beds.items():
        umf, bubbling = found[name], points[BUBBLING]
        print(f"{name}: {umf.number} packed; settled void fraction {umf.eps:.4f}; "
              f"Umf {1e3 * umf.umf:.3f} mm/s, by the drag law {1e3 * umf.law:.3f}")
        check_coupling(points, check)
        check("pressure drop over weight, bubbling", bubbling.ratio, 0.9, 1.1)
        check("  spread of the void fraction over the cells", bubbling.spread, 0.08, 0.3)
        law = np.array([carrying_velocity(p.eps, p.powder, SOLID) for p in points])
        if name != "cohesive":
            check("Umf over that of the drag law", umf.umf / umf.law, 0.85, 1.15)
            for p, u in zip(points[EXPANDED], law[EXPANDED], strict=True):
                check(f"expanded, {1e3 * p.velocity:g} mm/s: gas less solids over that of the law", p.slip / u, 0.9, 1.1)
        remarks.append(f"{name}: Umf {umf.umf:.5f} m/s, settled void fraction {umf.eps:.4f}, at which the drag law says {umf.law:.5f} m/s")
        rows += [(name, p.velocity, float(p.ratio), float(p.eps), float(p.spread), float(p.slip), float(u), float(p.height))
                 for p, u in zip(points, law, strict=True)]
    check("cohesion: settled void fraction less that without", found["cohesive"].eps - found["ssp"].eps, 0.005, 0.2)
    bulk.write_table(HERE / "bed.csv", ("bed", "velocity_m_s", "pressure_drop_over_weight", "void_fraction", "spread",
                                        "gas_less_solids_m_s", "law_m_s", "height_m"), rows, *remarks,
                     results=beds["ssp"][0].run.folder)
    draw(beds, found)
    sys.exit(check.failed > 0)


if __name__ == "__main__":
    main()

"""Check and draw the bubbling bed: usage: validate.py [RESULTS FOLDER]

Reads parcels.vtkhdf, gas.vtkhdf and monitor.h5, writes geldart_b_bed.png beside them, prints what was
checked and what the run cost, and exits with 1 where something is not as it must be.
"""

import sys
from pathlib import Path

import matplotlib
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import results  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.collections import EllipseCollection  # noqa: E402

START = 1.0  # s: the bed has forgotten how it began
BUBBLE = 0.7  # void fraction above which a cell inside the bed is bubble
SMALLEST_BUBBLE = 4  # cells of the depth-averaged void fraction
FASTEST_BUBBLE = 1.0  # m/s: farther than this in a frame, it is another one

VARIANTS = {"ssp": [], "ssw": ["parcels%weighting=ssw"]}  # the case as it stands, and its other weighting

# The case: what was asked for.
PARTICLE_DENSITY = 2500.0  # kg/m3
PSD = {"mean": 500e-6, "deviation": 125e-6, "smallest": 250e-6, "largest": 800e-6}  # m, log-normal by number
BED_MASS = 0.106  # kg
GRAVITY = 9.81  # m/s2


class Checks:
    """Lines of a table: what, value, what is allowed."""

    def __init__(self):
        self.failed = 0

    def __call__(self, what, value, low, high, unit="", shape="10.4g"):
        good = bool(np.isfinite(value) and low <= value <= high)
        self.failed += not good
        allowed = f"{low:g} to {high:g}" if np.isfinite(low) else f"at most {high:g}"
        print(f"  {'ok  ' if good else 'FAIL'}  {what:52} {value:{shape}} {unit:4} ({allowed})")


class Bubbles:
    """Bubbles followed through the frames of the depth-averaged void fraction."""

    def __init__(self, gas, first):
        self.seen = 0  # different bubbles
        self.sizes = []  # m, diameter of the circle of equal area
        self.speeds = []  # m/s, upwards
        self.frames = gas.count - first
        self.frames_with = 0
        previous = []
        for step in range(first, gas.count):
            present = self.find(gas, gas("void_fraction", step).mean(axis=0))
            self.frames_with += bool(present)
            self.sizes += [size for *_, size in present]
            if step > first:
                self.follow(previous, present, gas.times[step] - gas.times[step - 1])
            else:
                self.seen += len(present)
            previous = present

    @staticmethod
    def find(gas, eps):
        """Regions of gas that the bed encloses: (x, y, size) of each. What joins the freeboard is none."""
        labels, number = results.regions(eps > BUBBLE)
        free = set(labels[-1])  # the top row
        found = []
        for label in set(range(1, number + 1)) - free:
            rows, columns = np.nonzero(labels == label)
            if len(rows) < SMALLEST_BUBBLE or rows.min() == 0 and len(rows) < 2 * SMALLEST_BUBBLE:
                continue
            size = np.sqrt(4 / np.pi * len(rows) * gas.h[0] * gas.h[1])
            found.append((gas.centres(0)[columns].mean(), gas.centres(1)[rows].mean(), size))
        return found

    def follow(self, before, now, dt):
        """The nearest bubble of the frame before, above or little below it, is the same one."""
        left = list(before)
        for x, y, size in now:
            reach = FASTEST_BUBBLE * dt + size / 4
            near = [(np.hypot(x - a, y - b), (a, b, s)) for a, b, s in left]
            near = [pair for pair in near if pair[0] < reach and y - pair[1][1] > -size / 4]
            if not near:
                self.seen += 1
                continue
            old = min(near)[1]
            left.remove(old)
            self.speeds.append((y - old[1]) / dt)


def finer(sizes, weights, at):
    """Fraction of `weights` that belongs to sizes up to each of `at`."""
    order = np.argsort(sizes)
    total = np.concatenate([[0], np.cumsum(weights[order])])
    return total[np.searchsorted(sizes[order], at, side="right")] / total[-1]


def check(run, checks):
    """The table; returns what the summary says."""
    series, gas = run.series, run.gas
    time = series["time"]
    late = time >= START
    area = np.prod((gas.upper - gas.lower)[[0, 2]])
    last = run.parcels(-1)
    mass = np.sum(last["weight"] * last["diameter"] ** 3) * np.pi / 6 * PARTICLE_DENSITY
    weight = mass * GRAVITY / area
    drop, drop_error = results.mean_with_error(series["pressure_drop"][late] / weight)
    height, height_error = results.mean_with_error(series["bed_height"][late])
    bubbles = Bubbles(gas, int(np.searchsorted(gas.times, START)))

    print("checks")
    checks("mass of the bed over the mass asked for", mass / BED_MASS, 0.999, 1.001)
    checks("time-mean pressure drop over bed weight per area", drop, 0.95, 1.05)
    checks("parcels lost or gone", np.max(abs(series["parcels"] - series["parcels"][0]) + series["parcels_lost"]), 0, 0)
    checks("momentum given against taken, largest difference", np.nanmax(series["exchange_residual"]), -np.inf, 1e-12)
    checks("gas mass imbalance over inflow, largest", np.nanmax(series["mass_imbalance"]), -np.inf, 1e-6)
    # Two parcels meeting at 1 m/s, the fastest here, overlap by v sqrt(m*/k_n) = 0.28 radii.
    checks("largest overlap over radius", np.nanmax(series["max_overlap"][late]), -np.inf, 0.28)
    checks("mean overlap over radius", np.nanmean(series["mean_overlap"][late]), -np.inf, 0.02)
    check_places(run, checks)
    check_sizes(last, checks)
    checks("largest void fraction", max(gas("void_fraction", s).max() for s in range(gas.count)), 0.99, 1 + 1e-6)
    checks("smallest void fraction", min(gas("void_fraction", s).min() for s in range(gas.count)), 0.25, 0.5)
    checks("mean bed height", height, 0.07, 0.20, "m")
    checks("bubbles seen", bubbles.seen, 3, 1e4, shape="10d")
    checks("mean speed of bubbles, upwards", np.mean(bubbles.speeds) if bubbles.speeds else np.nan, 0.05, 1.0, "m/s")
    for name in ("parcels.vtkhdf", "gas.vtkhdf"):
        steps, items = results.vtk_steps(run.folder / name)
        expected = run.parcels if name.startswith("parcels") else gas
        checks(f"steps of {name} that VTK reads", steps, expected.count, expected.count, shape="10d")
        count = len(last["diameter"]) if name.startswith("parcels") else int(np.prod(gas.cells))
        checks("  with points or cells in the last", items, count, count, shape="10d")
    return {"drop": (drop, drop_error), "height": (height, height_error), "bubbles": bubbles, "weight": weight}


def check_places(run, checks):
    """Nothing may leak: every centre inside the vessel, at every step."""
    gas = run.gas
    outside = 0
    for step in range(run.parcels.count):
        x = run.parcels(step)["position"]
        outside += int(np.sum(np.any((x < gas.lower) | (x > gas.upper), axis=1)))
    checks("parcels outside the vessel, at any step", outside, 0, 0)


def check_sizes(parcels, checks):
    """The real particles the parcels stand for have the means of the powder asked for."""
    made = results.means(parcels["diameter"], parcels["weight"])
    sizes, number, _ = results.log_normal_by_number(**PSD)
    share = np.diff(number)
    asked = results.means((sizes[1:] + sizes[:-1]) / 2, share)
    for name, a, b in zip(("number", "Sauter", "mass"), made, asked):
        checks(f"{name} mean diameter, made over asked", a / b, 0.999, 1.001, shape="10.6f")


def draw(run, summary, path):
    """The bed at some instants, the series, the sizes."""
    parcels, gas = run.parcels, run.gas
    late = np.nonzero(parcels.times >= START)[0] if parcels.times[-1] > START else np.arange(parcels.count)
    chosen = late[np.linspace(0, len(late) - 1, 4).round().astype(int)]
    top = min(gas.upper[1], 1.15 * max(np.quantile(parcels(s)["position"][:, 1], 0.999) for s in chosen))
    panel = 1.25 * top / (gas.upper[0] - gas.lower[0])  # inches
    figure = plt.figure(figsize=(13, panel + 4.6), constrained_layout=True)
    grid = figure.add_gridspec(2, 1, height_ratios=[panel + 0.9, 3.7])
    draw_instants(figure, grid[0], run, chosen, top)
    below = grid[1].subgridspec(1, 3)
    draw_series(figure, below, run, summary)
    draw_sizes(figure.add_subplot(below[2]), run.parcels(-1))
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_instants(figure, place, run, chosen, top):
    """Parcels of the middle of the vessel, one cell deep, coloured by the size of their particles; the void fraction
    there beside them."""
    parcels, gas = run.parcels, run.gas
    middle, half = (gas.lower[2] + gas.upper[2]) / 2, gas.h[2] / 2
    layers = abs(gas.centres(2) - middle) < 1.01 * half
    axes = figure.add_subfigure(place).subplots(1, 2 * len(chosen), sharey=True)
    for pair, step in zip(axes.reshape(-1, 2), chosen):
        data = parcels(step)
        depth = data["position"][:, 2]
        order = np.argsort(depth)
        order = order[abs(depth[order] - middle) < half]
        x, d, w = data["position"][order], data["diameter"][order], data["weight"][order]
        across = d * np.cbrt(w) * 1e3
        dots = EllipseCollection(across, across, np.zeros_like(across), units="xy", offsets=x[:, :2] * 1e3,
                                 transOffset=pair[0].transData, array=d * 1e6, cmap="viridis", linewidths=0)
        dots.set_clim(PSD["smallest"] * 1e6, PSD["largest"] * 1e6)
        pair[0].add_collection(dots)
        near = int(np.argmin(abs(gas.times - parcels.times[step])))
        extent = [gas.lower[0] * 1e3, gas.upper[0] * 1e3, gas.lower[1] * 1e3, gas.upper[1] * 1e3]
        image = pair[1].imshow(gas("void_fraction", near)[layers].mean(axis=0), origin="lower", extent=extent,
                               cmap="magma", vmin=0.4, vmax=1, interpolation="nearest")
        pair[0].set_title(f"t = {parcels.times[step]:.2f} s", fontsize=10)
        for ax in pair:
            ax.set(xlim=extent[:2], ylim=(extent[2], top * 1e3), aspect="equal", xticks=[0, 30, 60])
    axes[0].set_ylabel("height, mm")
    figure.colorbar(dots, ax=axes, label="particle diameter, um", shrink=0.9, pad=0.01)
    figure.colorbar(image, ax=axes, label="void fraction", shrink=0.9, pad=0.01)


def draw_series(figure, grid, run, summary):
    time = run.series["time"]
    drop = figure.add_subplot(grid[0])
    drop.plot(time, run.series["pressure_drop"] / summary["weight"], lw=0.8)
    drop.axhline(1, color="k", lw=0.8, ls="--")
    mean, error = summary["drop"]
    drop.set(xlabel="time, s", ylabel="pressure drop over bed weight per area", ylim=(0, 2),
             title=f"mean after {START:g} s: {mean:.3f} ± {error:.3f}")
    height = figure.add_subplot(grid[1])
    height.plot(time, run.series["bed_height"] * 1e3, lw=0.8)
    mean, error = summary["height"]
    height.set(xlabel="time, s", ylabel="bed height, mm", title=f"mean: {mean * 1e3:.1f} ± {error * 1e3:.1f} mm")
    height.set_ylim(0, 1.3 * np.nanmax(run.series["bed_height"]) * 1e3)


def draw_sizes(ax, parcels):
    sizes, number, mass = results.log_normal_by_number(**PSD)
    d, w = parcels["diameter"], parcels["weight"]
    for asked, weights, name, colour in ((number, w, "number", "C0"), (mass, w * d**3, "mass", "C1")):
        ax.plot(sizes * 1e6, asked, color=colour, lw=3, alpha=0.4, label=f"asked, by {name}")
        ax.plot(sizes * 1e6, finer(d, weights, sizes), color=colour, lw=1, ls="--", label=f"made, by {name}")
    ax.set(xlabel="particle diameter, um", ylabel="fraction finer", title="size distribution")
    ax.legend(fontsize=8)


def tell_cost(run):
    """Wall time by part, and the work done in it."""
    series = run.series
    wall = series["wall_time"][-1] - series["wall_time"][0]
    parts = {name[10:]: values[-1] for name, values in series.items() if name.startswith("wall_time_")}
    print("the cost")
    print(f"  wall time                               {wall:.1f} s, {wall / (series['time'][-1] - series['time'][0]):.1f} s per simulated second")
    for name, seconds in sorted(parts.items(), key=lambda item: -item[1]):
        print(f"    {name:37} {seconds:.1f} s, {100 * seconds / sum(parts.values()):.0f} %")
    particle_steps = series["parcels"][0] * (series["solids_steps"][-1] - series["solids_steps"][0])
    cell_steps = np.prod(run.gas.cells) * (series["gas_steps"][-1] - series["gas_steps"][0])
    for name, steps, part in (("parcel", particle_steps, "parcels"), ("cell", cell_steps, "gas")):
        alone = f", {steps / parts[part] / 1e6:.3g} in the {part} part alone" if part in parts else ""
        print(f"  million {name + ' steps per second':31} {steps / wall / 1e6:.3g}{alone}")


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "results"
    if not (folder / "monitor.h5").exists():
        sys.exit(f"there are no results in {folder}: make run")
    run = results.Run(folder)
    checks = Checks()
    summary = check(run, checks)
    picture = run.folder / "geldart_b_bed.png"
    draw(run, summary, picture)
    bubbles = summary["bubbles"]
    print("the bed")
    print(f"  pressure drop over bed weight per area  {summary['drop'][0]:.3f} ± {summary['drop'][1]:.3f}")
    print(f"  mean bed height                         {summary['height'][0] * 1e3:.1f} ± {summary['height'][1] * 1e3:.1f} mm")
    size = np.mean(bubbles.sizes) * 1e3 if bubbles.sizes else 0
    print(f"  bubbles seen                            {bubbles.seen}, of {size:.0f} mm on average")
    tell_cost(run)
    print(f"results  {run.folder}")
    print(f"picture  {picture}")
    if checks.failed:
        sys.exit(f"{checks.failed} of the checks FAILED")


if __name__ == "__main__":
    main()

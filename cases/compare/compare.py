"""What coarse-graining costs and loses: one bed as DEM, as SSW and as SSP.

usage: compare.py [FOLDER WITH dem, ssw AND ssp]

Prints the table, writes it to compare.md beside a picture compare.png. Every time mean comes with its
statistical error; a difference from DEM is given with the error of the difference.
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

START = 1.0  # s: means are taken from here on
LAYERS = 4e-3  # m: height of the layers of the Sauter diameter
FEWEST = 10  # parcels in a layer for a diameter to mean something
RUNS = ("dem", "ssw", "ssp")
VARIANTS = {name: [f"parcels%weighting={name}"] for name in RUNS}
PARTICLE_DENSITY, GRAVITY = 2500.0, 9.81


class Bed:
    """Time means of one run, each as (mean, standard error); profiles as arrays of both."""

    def __init__(self, folder):
        run = results.Run(folder)
        series, gas, parcels = run.series, run.gas, run.parcels
        late = series["time"] >= START
        first = parcels(0)
        mass = np.sum(first["weight"] * first["diameter"] ** 3) * np.pi / 6 * PARTICLE_DENSITY
        area = np.prod((gas.upper - gas.lower)[[0, 2]])
        self.drop = results.mean_with_error(series["pressure_drop"][late] * area / (mass * GRAVITY))
        self.height = results.mean_with_error(series["bed_height"][late] * 1e3)
        self.heights = gas.centres(1) * 1e3
        eps = [gas("void_fraction", s).mean(axis=(0, 2)) for s in range(gas.count) if gas.times[s] >= START]
        self.eps = profile(np.array(eps))
        self.layers = np.arange(gas.lower[1], gas.upper[1] + LAYERS / 2, LAYERS)
        steps = [s for s in range(parcels.count) if parcels.times[s] >= START]
        self.sauter = profile(np.array([self.sauter_of(parcels(s)) for s in steps]) * 1e6)
        self.parcels = len(first["diameter"])
        self.cost(series)

    def sauter_of(self, data):
        """Sauter diameter of the real particles in each layer [m], nan where there are too few parcels."""
        layer = np.digitize(data["position"][:, 1], self.layers) - 1
        number = len(self.layers) - 1
        cubes, squares, count = (
            np.bincount(layer.clip(0, number - 1), amount, number)
            for amount in (data["weight"] * data["diameter"] ** 3, data["weight"] * data["diameter"] ** 2, np.ones_like(layer))
        )
        return np.where(count >= FEWEST, cubes / np.maximum(squares, 1e-300), np.nan)

    def cost(self, series):
        self.wall = series["wall_time"][-1] - series["wall_time"][0]
        self.steps = series["solids_steps"][-1]
        self.contacts = np.mean(series["contacts"][series["time"] >= START])


def profile(frames):
    """Mean and error of every place of (times, places); nan where it was seen in less than half of the frames."""
    seen = np.isfinite(frames).mean(axis=0) > 0.5
    pairs = [results.mean_with_error(column) if good else (np.nan, np.nan) for column, good in zip(frames.T, seen)]
    return np.array(pairs).T


def apart(a, b):
    """Difference of two means and its error."""
    return a[0] - b[0], np.hypot(a[1], b[1])


def distance(a, b):
    """Root mean square difference of two profiles, and what the statistical errors alone would give."""
    difference, error = apart(a, b)
    both = np.isfinite(difference) & np.isfinite(error)
    return np.sqrt(np.mean(difference[both] ** 2)), np.sqrt(np.mean(error[both] ** 2))


def table(beds):
    """Rows of text."""
    dem = beds["dem"]
    rows = [["", *(name.upper() for name in RUNS)]]

    def add(label, cell):
        rows.append([label, *(cell(name, bed) for name, bed in beds.items())])

    def mean(pick, digits):
        return lambda name, bed: "{:.{n}f} ± {:.{n}f}".format(*pick(bed), n=digits)

    def from_dem(measure, digits):
        def cell(name, bed):
            return "" if name == "dem" else "{:.{n}f} ± {:.{n}f}".format(*measure(bed), n=digits)

        return cell

    add("parcels", lambda name, bed: f"{bed.parcels}")
    add("solids steps", lambda name, bed: f"{bed.steps:.0f}")
    add("contacts at a time", lambda name, bed: f"{bed.contacts:.0f}")
    add("wall time, s", lambda name, bed: f"{bed.wall:.1f}")
    add("times faster than DEM", lambda name, bed: f"{dem.wall / bed.wall:.1f}")
    add("pressure drop over bed weight per area", mean(lambda bed: bed.drop, 3))
    add("  minus DEM", from_dem(lambda bed: apart(bed.drop, dem.drop), 3))
    add("bed height, mm", mean(lambda bed: bed.height, 2))
    add("  minus DEM", from_dem(lambda bed: apart(bed.height, dem.height), 2))
    add("void fraction profile, rms from DEM (and by chance)", lambda name, bed: pair(name, bed.eps, dem.eps, 4))
    add("Sauter diameter against height, rms from DEM, um (and by chance)",
        lambda name, bed: pair(name, bed.sauter, dem.sauter, 1))
    return rows


def pair(name, a, b, digits):
    return "" if name == "dem" else "{:.{n}f} ({:.{n}f})".format(*distance(a, b), n=digits)


def markdown(rows):
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join([lines[0], "|---" * len(rows[0]) + "|", *lines[1:]]) + "\n"


def draw(beds, path):
    figure, axes = plt.subplots(1, 4, figsize=(13, 4), constrained_layout=True)
    for number, (name, bed) in enumerate(beds.items()):
        colour = f"C{number}"
        middle = (bed.layers[1:] + bed.layers[:-1]) / 2 * 1e3
        axes[0].barh(number, bed.wall, color=colour)
        axes[0].text(bed.wall, number, f" {bed.wall:.0f} s", va="center")
        axes[1].errorbar(*bed.height[:1], *bed.drop[:1], xerr=bed.height[1], yerr=bed.drop[1], fmt="o", color=colour)
        for ax, (mean, error), height in ((axes[2], bed.eps, bed.heights), (axes[3], bed.sauter, middle)):
            ax.plot(mean, height, color=colour, label=name.upper())
            ax.fill_betweenx(height, mean - error, mean + error, color=colour, alpha=0.25, lw=0)
    axes[0].set(yticks=range(len(beds)), yticklabels=[name.upper() for name in beds], xlabel="wall time, s")
    axes[0].margins(x=0.25)
    axes[0].invert_yaxis()
    axes[1].set(xlabel="bed height, mm", ylabel="pressure drop over bed weight per area")
    axes[2].set(xlabel="void fraction", ylabel="height, mm")
    axes[3].set(xlabel="Sauter diameter, um", ylabel="height, mm")
    axes[3].legend()
    figure.savefig(path, dpi=110)


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "results"
    beds = {name: Bed(folder / name) for name in RUNS}
    text = markdown(table(beds))
    (folder / "compare.md").write_text(text)
    draw(beds, folder / "compare.png")
    print(text, f"table    {folder / 'compare.md'}", f"picture  {folder / 'compare.png'}", sep="\n")


if __name__ == "__main__":
    main()

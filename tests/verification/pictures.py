"""Pictures of doc/verification.md: curves the programs printed, and errors of checks.csv beside MFIX's."""

import matplotlib
import numpy as np

from catalogue import error_of

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

OURS, EXACT, PEER = "#1f6fb4", "0.25", "#d1762b"
STYLE = {"font.size": 8, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.alpha": 0.3,
         "legend.frameon": False, "lines.linewidth": 1.2, "figure.dpi": 110, "figure.constrained_layout.use": True}


def series(curves, name):
    return np.array(curves[name]).T


def fall(rows, curves):
    figure, (path, errors) = plt.subplots(1, 2, figsize=(6.4, 2.5))
    for e, shade in (("1.0", 1), ("0.8", 0.65), ("0.6", 0.4)):
        t, z, exact = series(curves, f"fall_k25000_e{e}")
        path.plot(t, exact, color=EXACT, lw=0.8)
        path.plot(t[::12], z[::12], "o", ms=2.5, color=OURS, alpha=shade, label=f"e {float(e):g}")
        errors.plot(t, 1000 * (z - exact), color=OURS, alpha=shade, label=f"e {float(e):g}")
    path.set(xlabel="time, s", ylabel="height, m", title="k 25 000 N/m; line: exact")
    errors.set(xlabel="time, s", ylabel="error, mm", title="where the error arises")
    path.legend()
    errors.legend()
    return figure


def squeezed(rows, curves):
    figure, axes = plt.subplots(1, 2, figsize=(6.4, 2.5))
    for e, shade in (("1.0", 1), ("0.9", 0.65), ("0.5", 0.4)):
        t, z, exact = series(curves, f"squeezed_e{e}")
        if e != "1.0":
            near = t < 0.12
            axes[0].plot(t[near], exact[near], color=EXACT, lw=0.8)
            axes[0].plot(t[near][::5], z[near][::5], "o", ms=2.5, color=OURS, alpha=shade, label=f"e {float(e):g}")
        axes[1].plot(t, 1000 * (z - exact), color=OURS, alpha=shade, lw=0.8, label=f"e {float(e):g}")
    axes[0].set(xlabel="time, ms", ylabel="rise, um", title="upper ball; line: exact")
    axes[1].set(xlabel="time, ms", ylabel="error, nm", title="its error")
    axes[0].legend()
    axes[1].legend()
    return figure


def oblique(rows, curves):
    figure, axes = plt.subplots(1, 2, figsize=(6.4, 2.5), sharey=True)
    for axis, where in zip(axes, ("wall", "pair"), strict=True):
        for material, mark in (("glass", "o"), ("acetate", "s")):
            x, found, hard = series(curves, f"oblique_{where}_{material}")
            axis.plot(x, hard, color=EXACT, lw=0.8)
            axis.plot(x, found, mark, ms=4, mfc="none", color=OURS, label=material)
        axis.set(xlabel="$\\Psi_1$", title=f"{where}; line: hard spheres")
    axes[0].set_ylabel("$\\Psi_2$")
    axes[0].legend()
    return figure


def chung_ooi(rows, curves):
    figure, axes = plt.subplots(1, 2, figsize=(6.4, 2.7))
    for axis, (left, right), prefix in ((axes[0], ("steel", "polyethylene"), "oblique5"), (axes[1], ("aluminium", "nylon"), "spinning6")):
        for material, mark, shade in ((left, "o", 1), (right, "s", 0.5)):
            x, found, published = series(curves, f"{prefix}_{material}")
            axis.plot(x, published, mark, ms=4, mfc="none", color=PEER, alpha=shade, label=f"{material}, published")
            axis.plot(x, found, "-", color=OURS, alpha=shade, label=f"{material}, geldart")
    x, _, elements = series(curves, "oblique5_finite_elements")
    axes[0].plot(x, elements, ":", color=EXACT, label="steel, finite elements")
    axes[0].set(xlim=(0, 13.5), xlabel="$\\Psi_1$", ylabel="$\\Psi_2$", title="test 5")
    axes[1].set(xscale="log", xlabel="7/2 $\\mu$ (1 + e) $v_n/v_t$", ylabel="$\\beta$", title="test 6")
    for axis in axes:
        axis.legend(fontsize=6)
    return figure


def order(rows, curves):
    figure, axis = plt.subplots(figsize=(3.6, 2.6))
    for name, mark, label in (("order_elastic", "o-", "e 1"), ("order_damped", "s-", "e 0.6")):
        x, error, _ = series(curves, name)
        axis.loglog(x, error, mark, ms=4, color=OURS, mfc="none" if "damped" in name else OURS, label=label)
    for name, line, label in (("order_elastic", "--", "fourth order"), ("order_damped", ":", "second order")):
        x, _, slope = series(curves, name)
        axis.loglog(x, slope, line, color=EXACT, label=label)
    axis.set_xticks(x, [f"1/{round(1 / share)}" for share in x])
    axis.minorticks_off()
    axis.set(xlabel="dt/t_c", ylabel="error of a collision")
    axis.legend()
    return figure


def manufactured(rows, curves):
    figure, axes = plt.subplots(1, 2, figsize=(6.4, 2.6), sharey=True)
    for axis, what in zip(axes, ("velocity", "pressure"), strict=True):
        for name, mark, label in (("flat", "o", "flat"), ("flat_graded", "s", "flat, graded"),
                                  ("flat_van_leer", "^", "flat, van Leer"), ("solid", "d", "three dimensions")):
            x, error, slope = series(curves, f"manufactured_{name}_{what}")
            axis.loglog(x, error, mark, ms=4, mfc="none", color=OURS, label=label)
            axis.loglog(x, slope, color=EXACT, lw=0.7, label="second order" if name == "solid" else None)
        axis.set_xticks([1 / 64, 1 / 32, 1 / 16, 1 / 8], ["1/64", "1/32", "1/16", "1/8"])
        axis.minorticks_off()
        axis.set(xlabel="edge of a cell [m]", title=what)
    axes[0].set_ylabel("error, root mean square")
    axes[0].legend(fontsize=7)
    return figure


def pipe(rows, curves):
    figure, (profile, errors) = plt.subplots(1, 2, figsize=(6.4, 2.6))
    for n, mark in (("8", "^"), ("16", "s"), ("32", "o")):
        r, found, _ = series(curves, f"pipe_profile_{n}")
        profile.plot(r, found, mark, ms=3 if n == "8" else 2, mfc="none", color=OURS, alpha=0.4 if n == "32" else 1, label=f"{n} cells")
    r = np.linspace(0, 1, 100)
    profile.plot(r, 1 - r**2, color=EXACT, lw=0.8, label="exact")
    profile.set(xlabel="r/R", ylabel="velocity over the largest", title="round pipe, cells that are whole")
    for name, mark, label in (("pipe", "o", "round pipe"), ("turned_duct", "s", "turned square duct")):
        x, error, slope = series(curves, f"{name}_errors")
        errors.loglog(x, error, mark, ms=4, mfc="none", color=OURS, label=label)
        errors.loglog(x, slope, color=EXACT, lw=0.7, label="second order" if name == "pipe" else None)
    errors.set_xticks([1 / 32, 1 / 16, 1 / 8], ["1/32", "1/16", "1/8"])
    errors.minorticks_off()
    errors.set(xlabel="width of a cell over that of the pipe", ylabel="error, %", title="flow")
    for axis in (profile, errors):
        axis.legend(fontsize=7)
    return figure


def cooling(rows, curves):
    figure, axes = plt.subplots(1, 2, figsize=(6.4, 2.5))
    for axis, e in zip(axes, ("0.90", "0.95"), strict=True):
        for phi, mark in (("0.05", "o"), ("0.10", "s"), ("0.15", "^")):
            x, found, haff = series(curves, f"haff_e{e}_phi{phi}")
            axis.plot(x[::4], found[::4], mark, ms=3.5, mfc="none", color=OURS, label=f"phi {float(phi):g}")
        axis.plot(x, haff, color=EXACT, lw=0.8, label="Haff")
        axis.set(xlabel="t/t_0", ylabel="T/T_0", title=f"e {float(e):g}")
        axis.legend()
    return figure


def shear(rows, curves):
    figure, axis = plt.subplots(figsize=(6.4, 2.2))
    for phi, shade in (("0.10", 1), ("0.20", 0.65), ("0.30", 0.4)):
        x, found, theory = series(curves, f"shear_phi{phi}")
        axis.plot(x, found / theory, color=OURS, alpha=shade, lw=0.8, label=f"phi {float(phi):g}")
    axis.axhline(1, color=EXACT, lw=0.8)
    axis.axvline(5, color=EXACT, lw=0.8, ls=":")
    axis.set(xlabel="strain", ylabel="T over theory", ylim=(0, 2))
    axis.legend()
    return figure


def crossing(rows, curves):
    figure, (drop, spectrum) = plt.subplots(1, 2, figsize=(6.4, 2.7))
    styles = (("cell", PEER, "by cell"), ("linear", "#7fb2da", "trilinear"), ("half", "#4d93cc", "width h/2"), ("one", OURS, "width h"),
              ("two", "#0b3c66", "width 2 h"))
    for name, colour, label in styles:
        x, found, _ = series(curves, f"crossing_{name}")
        drop.plot(x, found, color=colour, label=label)
        k, amplitude, _ = series(curves, f"crossing_spectrum_{name}")
        spectrum.semilogy(k, amplitude, "o-", ms=3, color=colour)
    drop.set(xlabel="cells crossed", ylabel="pressure drop over its mean", ylim=(0.7, 1.5), title="by cell it reaches 4.8")
    spectrum.set(xlabel="frequency over that of crossing", ylabel="amplitude over the mean", ylim=(1e-5, 1), title="spectrum")
    drop.legend(fontsize=6)
    return figure


def balance(rows, curves):
    figure, axis = plt.subplots(figsize=(3.2, 2.7))
    asked, cells, _ = series(curves, "balance_cells")
    _, whole, _ = series(curves, "balance_whole")
    axis.loglog(asked, asked, color=EXACT, lw=0.8, label="tolerance")
    axis.loglog(asked, cells, "o-", ms=3, color=OURS, label="sum of the cells'")
    axis.loglog(asked, whole, "s-", ms=3, color="#7fb2da", label="whole vessel's")
    axis.loglog(*series(curves, "balance_floor")[:2], "o", ms=5, mfc="none", color=OURS, label="asked for 1e-15")
    axis.set(xlabel="tolerance", ylabel="imbalance of mass over the inflow")
    axis.legend(fontsize=6)
    return figure


def errors(rows, curves):
    """Every row that has a peer: our error and MFIX's, both over MFIX's, and the half that is allowed. Cut at a thousandth."""
    compared = [row for row in rows if row["peer"]]
    figure, axis = plt.subplots(figsize=(6.4, 0.17 * len(compared) + 0.7))
    ratio = [max(error_of(row) / float(row["peer"]), 1e-3) for row in compared]
    place = np.arange(len(compared))[::-1]
    axis.axvspan(0.5, 100, color="0.93", lw=0)
    axis.axvline(1.0, color=PEER, label="MFIX")
    axis.plot(ratio, place, "o", ms=4, color=OURS, label="geldart")
    axis.set_yticks(place, [row["name"] for row in compared], fontsize=6)
    axis.set(xscale="log", xlim=(7e-4, max(2 * max(ratio), 2)), ylim=(-0.7, len(compared) - 0.3),
             xlabel="error over MFIX's, a thousandth or less at the left; shaded: more than half of it")
    axis.legend(loc="upper left", fontsize=7)
    return figure


def cavity(rows, curves):
    figure, axes = plt.subplots(1, 2, figsize=(6.4, 2.5))
    for axis, line in zip(axes, "uv", strict=True):
        for reynolds, shade in ((100, 0.4), (400, 0.65), (1000, 1)):
            place, _, ghia = series(curves, f"cavity_{line}_{reynolds}")
            lines = dict(zip("xuv", series(curves, f"cavity_lines_{reynolds}"), strict=True))
            axis.plot(lines["x"], lines[line], color=OURS, alpha=shade, label=f"Re {reynolds}")
            axis.plot(place, ghia, "o", ms=2.5, mfc="none", color=EXACT, alpha=shade)
    axes[0].set(xlabel="y", ylabel="u", title="u at x = 1/2; circles: Ghia")
    axes[1].set(xlabel="x", ylabel="v", title="v at y = 1/2")
    axes[0].legend()
    return figure


def draw(rows, curves, folder):
    """All pictures; their paths. The same rows and curves give the same bytes."""
    folder.mkdir(exist_ok=True)
    with plt.rc_context(STYLE):
        for make in (errors, fall, squeezed, oblique, chung_ooi, order, pipe, manufactured, cavity, cooling, shear, crossing,
                     balance):
            path = folder / f"{make.__name__}.png"
            figure = make(rows, curves)
            figure.savefig(path, metadata={"Software": None})
            plt.close(figure)
            yield path

"""Beds against what a textbook says of them."""

import sys

import numpy as np
import pytest

from conftest import ROOT

sys.path.insert(0, str(ROOT / "cases"))
from results import Run  # noqa: E402

DENSITY, VISCOSITY, GRAVITY = 1.2, 1.8e-5, 9.81


def compute(geldart, tmp_path, case, *options):
    """Run a case with some keys set and open its results."""
    done = geldart(ROOT / "tests/runs" / case, "--out", "out", *(word for option in options for word in ("--set", option)))
    assert done.returncode == 0, done.stderr
    return Run(tmp_path / "out")


def ergun(eps, diameter, velocity):
    """Pressure gradient of a packed bed at a superficial velocity [Pa/m]. Ergun, Chem. Eng. Prog. 48 (1952) 89."""
    return (150 * VISCOSITY * (1 - eps) ** 2 / (eps**3 * diameter**2) * velocity
            + 1.75 * DENSITY * (1 - eps) / (eps**3 * diameter) * velocity**2)


def ergun_side_by_side(eps, diameter, velocity):
    """The same of columns side by side that share the gas, given the void fraction of each."""
    low, high = 0.0, ergun(eps, diameter, velocity).max()
    square = 1.75 * DENSITY * (1 - eps) / (eps**3 * diameter)
    linear = ergun(eps, diameter, 1.0) - square
    for _ in range(60):
        gradient = (low + high) / 2
        flow = 2 * gradient / (linear + np.sqrt(linear**2 + 4 * square * gradient))
        low, high = (gradient, high) if flow.mean() < velocity else (low, gradient)
    return low


# Every particle a parcel: a smaller vessel and softer particles keep the run short.
PARTICLES = ["parcels%weight=1", "domain%upper=0.006, 0.016, 0.006", "grid%cells=3, 8, 3", "contact%stiffness=20",
             "fill(bed)%upper=0.006, 0.011, 0.006", "fill(bed)%mass=5e-4", "boundary(distributor)%upper=0.006, 0, 0.006",
             "boundary(top)%lower=0, 0.016, 0", "boundary(top)%upper=0.006, 0.016, 0.006", "run%end_time=0.15",
             "output%parcels_interval=0.15", "output%gas_interval=0.15"]


@pytest.mark.parametrize("options", [PARTICLES, ["run%end_time=0.2"]], ids=["W=1", "W=27"])
def test_packed_bed(geldart, tmp_path, options):
    """Below fluidization the pressure drop is Ergun's of the bed's own void fraction, whatever the weight.

    With the mean void fraction of each layer to 5 %: gas prefers the looser rim beside the walls. Where that is
    taken into account, layer by layer, to 2 %.
    """
    run = compute(geldart, tmp_path, "plug.nml", *options)
    eps, pressure, height = run.gas("void_fraction", -1), run.gas("pressure", -1).mean(axis=(0, 2)), run.gas.h[1]
    assert np.abs(run.parcels(-1)["velocity"]).max() < 0.01
    packed = np.nonzero(eps.mean(axis=(0, 2)) < 0.5)[0]
    low, high = packed[0], packed[-1]
    assert low == 0 and high >= 3
    layers = [eps[:, layer, :] for layer in range(low, high + 1)]
    for law, tolerance in ((lambda e: ergun(e.mean(), 500e-6, 0.12), 0.05), (lambda e: ergun_side_by_side(e, 500e-6, 0.12), 0.02)):
        gradient = np.array([law(e) for e in layers]) + DENSITY * GRAVITY
        expected = height * (gradient.sum() - (gradient[0] + gradient[-1]) / 2)  # from centre to centre
        assert pressure[low] - pressure[high] == pytest.approx(expected, rel=tolerance)


def cells_around(gas, position):
    """The eight cells that surround positions, with their trilinear weights; beyond the last centres the last cells."""
    place = np.clip((position - gas.lower) / gas.h - 0.5, 0, gas.cells - 1)
    cell = np.minimum(place.astype(int), gas.cells - 2)
    for corner in np.ndindex(2, 2, 2):
        yield tuple((cell + corner).T[::-1]), np.prod(np.where(corner, place - cell, 1 - (place - cell)), axis=1)


def at_parcels(gas, field, position):
    """A cell field (z, y, x), interpolated linearly to positions."""
    return sum(weight * field[cells] for cells, weight in cells_around(gas, position))


def gidaspow(reynolds, eps):
    """Drag factor, real diameters. MFIX 25.2.1, drag_gs.f."""
    return np.where(eps > 0.8, (1 + 0.15 * reynolds**0.687) * eps**-3.65, (150 * (1 - eps) + 1.75 * reynolds) / (18 * eps**2))


def beetstra(reynolds, eps):
    """Drag factor. Beetstra, van der Hoef, Kuipers, AIChE J. 53 (2007) 489."""
    phi = 1 - eps
    fast = (1 / eps + 3 * eps * phi + 8.4 * reynolds**-0.343) / (1 + 10 ** (3 * phi) * reynolds ** (-0.5 - 2 * phi))
    return 10 * phi / eps**2 + eps**2 * (1 + 1.5 * phi**0.5) + 0.413 * reynolds / (24 * eps**2) * fast


def mean_around(gas, parcels):
    """Sauter mean of the particles around each parcel: solids of the cells over their surface, by the weights of each."""
    volume, surface = np.zeros(gas.cells[::-1]), np.zeros(gas.cells[::-1])
    for cells, weight in cells_around(gas, parcels["position"]):
        np.add.at(volume, cells, weight * parcels["weight"] * parcels["diameter"] ** 3)
        np.add.at(surface, cells, weight * parcels["weight"] * parcels["diameter"] ** 2)
    return at_parcels(gas, volume, parcels["position"]) / at_parcels(gas, surface, parcels["position"])


@pytest.mark.parametrize("weighting, sizes", [("ssp", False), ("ssw", False), ("ssp", True)])
def test_polydisperse_bed(geldart, tmp_path, weighting, sizes):
    """The pressure gradient bears what the drag law says of the real particles, each in the gas it meets,
    and among the sizes around it.

    From the centres of the lowest cells to those of the highest, eps grad p = drag per volume; half of the drag on the
    lowest cells lies below their centres. To half a percent: walls and the turning of the gas bear the rest.
    """
    run = compute(geldart, tmp_path, "bed.nml", "boundary(distributor)%velocity=0.15", f"parcels%weighting={weighting}",
                  "run%end_time=0.3", "output%parcels_interval=0.3", "output%gas_interval=0.3",
                  *(["coupling%drag=beetstra", "coupling%polydispersity=beetstra"] if sizes else []))
    parcels, gas = run.parcels(-1), run.gas
    assert np.abs(parcels["velocity"]).max() < 0.05
    void, pressure, velocity = (gas(name, -1) for name in ("void_fraction", "pressure", "velocity"))
    eps = at_parcels(gas, void, parcels["position"])
    slip = at_parcels(gas, velocity[..., 1], parcels["position"]) - parcels["velocity"][:, 1]
    d = parcels["diameter"]
    if sizes:
        mean = mean_around(gas, parcels)
        factor = (d / mean + 0.064 * (d / mean) ** 3) * beetstra(DENSITY * eps * slip * mean / VISCOSITY, eps)
    else:
        factor = gidaspow(DENSITY * eps * slip * d / VISCOSITY, eps)
    drag = parcels["weight"] * 3 * np.pi * VISCOSITY * d * eps * factor * slip
    lowest = sum(np.sum((weight * drag)[cells[1] == 0]) for cells, weight in cells_around(gas, parcels["position"]))
    gradient = pressure[:, :-1] - pressure[:, 1:] - DENSITY * GRAVITY * gas.h[1]
    borne = np.sum(gradient * (void[:, :-1] + void[:, 1:]) / 2) * gas.h[0] * gas.h[2]
    assert borne == pytest.approx(drag.sum() - lowest / 2, rel=0.005)
    assert run.series["pressure_drop"][-1] < 0.9 * run.series["weight_per_area"][-1]


def test_parcels_wider_than_cells(geldart, tmp_path):
    """A packed bed in cells as wide as its parcels and half as wide, on one and two ranks: the same pressure drop, of no volume hidden,
    and what the gas gives the parcels get, to round-off."""
    drops = []
    for cells, ranks in (("9 24 3", 1), ("18 48 6", 1), ("18 48 6", 2)):
        out = f"out{len(drops)}"
        done = geldart(ROOT / "cases/wide_parcels/case.nml", "--out", out, "--set", f"grid%cells={cells}", "--set", "run%end_time=0.06",
                       ranks=ranks)
        assert done.returncode == 0, done.stderr
        series = Run(tmp_path / out).series
        assert series["exchange_residual"].max() < 1e-12
        assert series["clipped_volume"].max() == 0
        drops.append(series["pressure_drop"][-10:].mean())
    assert drops[1] == pytest.approx(drops[0], rel=0.02)
    assert drops[2] == pytest.approx(drops[1], rel=0.002)

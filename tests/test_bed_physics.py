"""Beds against what a textbook says of them."""

import sys

import numpy as np
import pytest

from conftest import ROOT

sys.path.insert(0, str(ROOT / "cases"))
from results import Run  # noqa: E402

DENSITY, VISCOSITY = 1.2, 1.8e-5


def ergun(eps, diameter, velocity):
    """Pressure gradient of a packed bed at a superficial velocity [Pa/m]. Ergun, Chem. Eng. Prog. 48 (1952) 89."""
    return (150 * VISCOSITY * (1 - eps) ** 2 / (eps**3 * diameter**2) * velocity
            + 1.75 * DENSITY * (1 - eps) / (eps**3 * diameter) * velocity**2)


@pytest.mark.parametrize("weight", [1, 27])
def test_packed_bed(geldart, tmp_path, weight):
    """Below fluidization the pressure drop is Ergun's of the bed's own void fraction, whatever the weight."""
    options = [f"parcels%weight={weight}"]
    if weight == 1:  # every particle is a parcel: a narrower vessel and softer particles keep the run short
        options += ["domain%upper=0.008, 0.048, 0.008", "grid%cells=2, 12, 2", "run%end_time=0.1", "contact%stiffness=30",
                    "fill(bed)%upper=0.008, 0.03, 0.008", "fill(bed)%mass=2e-3", "boundary(distributor)%upper=0.008, 0, 0.008",
                    "boundary(top)%lower=0, 0.048, 0", "boundary(top)%upper=0.008, 0.048, 0.008"]
    sets = [word for option in options for word in ("--set", option)]
    done = geldart(ROOT / "tests/runs/plug.nml", "--out", "out", *sets)
    assert done.returncode == 0, done.stderr
    run = Run(tmp_path / "out")
    eps = run.gas("void_fraction", -1)
    pressure = run.gas("pressure", -1)
    velocity = 0.12
    # Between the centres of two layers deep in the bed.
    layers = eps.mean(axis=(0, 2))
    deep = np.nonzero(layers < 0.55)[0]
    low, high = deep[0], deep[-2]
    gradient = ergun(layers, 500e-6, velocity)
    expected = run.gas.h[1] * (gradient[low:high + 1].sum() - (gradient[low] + gradient[high]) / 2)
    expected += DENSITY * 9.81 * run.gas.h[1] * (high - low)
    drop = pressure[:, low].mean() - pressure[:, high].mean()
    assert drop == pytest.approx(expected, rel=0.05)
    assert np.abs(run.parcels(-1)["velocity"]).max() < 0.02

"""A bed in a cylinder that cuts the cells of the gas: the vessel is as large as it should be, nothing is lost in it."""

import h5py
import numpy as np
import pytest

from conftest import ROOT

CASE = ROOT / "tests/runs/vessel.nml"


@pytest.fixture
def runs(geldart, tmp_path):
    """Series of the first 20 ms on 1 and 2 ranks."""
    found = {}
    for ranks in (1, 2):
        done = geldart(CASE, "--out", f"on{ranks}", "--set", "run%end_time=0.02", "--set", "output%gas_interval=0.02",
                       "--set", "numerics%tolerance=1e-10", "--set", "numerics%velocity_tolerance=1e-10", ranks=ranks)
        assert done.returncode == 0, done.stdout + done.stderr
        with h5py.File(tmp_path / f"on{ranks}/monitor.h5") as file:
            found[ranks] = {name: values[()] for name, values in file["series"].items()}
    return found


def test_vessel(runs, tmp_path):
    for series in runs.values():
        assert not series["parcels_lost"].any()
        assert series["mass_imbalance"].max() < 1e-9
        assert series["exchange_residual"].max() < 1e-12
    for name in ("pressure_drop", "bed_height", "gas_outflow"):
        one, two = runs[1][name], runs[2][name]
        assert np.allclose(one, two, rtol=1e-7, atol=1e-9 * abs(one).max()), name
    with h5py.File(tmp_path / "on1/gas.vtkhdf") as file:
        cells = {name: values[-1].astype(float) for name, values in file["VTKHDF/CellData"].items()}
    volume = cells["open_fraction"] * 0.004**3
    assert volume.sum() == pytest.approx(np.pi * 0.02**2 * 0.16, rel=0.005)
    # the gas sees every parcel whole, near the curved wall as well
    solids = ((1 - cells["void_fraction"]) * volume).sum() + runs[1]["clipped_volume"][-1]
    assert solids == pytest.approx(runs[1]["parcel_mass"][-1] / 2500, rel=1e-5)

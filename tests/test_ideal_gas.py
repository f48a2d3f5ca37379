"""Beds in an ideal gas: its mass is kept, ranks and restarts make no difference, steps that fail leave no trace."""

import h5py
import numpy as np
import pytest

from conftest import ROOT
from test_runs import TIGHT, data, run, same_results, series, state, until

BED = ROOT / "tests/runs/ideal.nml"
REFERENCE = 101325.0
PSI = 0.02896 / (8.31446261815324 * 293.15)
CELL = 0.004**3
CLOSED = ("boundary(top)%kind=no_slip", "boundary(distributor)%mass_flow=1e-3")


def mass(path):
    """Of the gas in a restart file, from its pressure and void fraction."""
    kept = state(path)
    return np.sum(PSI * (REFERENCE + kept["gas_pressure"]) * kept["void_fraction"]) * CELL


@pytest.mark.parametrize("where", [(), CLOSED], ids=["open", "closed"])
def test_mass(geldart, tmp_path, where):
    """What is in the vessel later is what was and what has come in less what has gone out, also where it cannot."""
    run(geldart, "out", *TIGHT, *where, until(0.002), case=BED)
    first = mass(tmp_path / "out/restart.h5")
    run(geldart, "out", *TIGHT, *where, until(0.02), case=BED, restart="out/restart.h5")
    last = mass(tmp_path / "out/restart.h5")
    rows = series(tmp_path / "out")
    later = rows["time"] > 0.0021
    assert later.sum() == 18
    come = np.sum((rows["gas_step"] * rows["gas_inflow"])[later])
    gone = np.sum((rows["gas_step"] * rows["gas_outflow"])[later])
    assert last - first == pytest.approx(come - gone, abs=1e-11 * come)
    assert rows["mass_imbalance"].max() <= 1e-12
    if where:
        assert gone == 0
        assert come == pytest.approx(1.8e-5, rel=1e-12)
    else:
        assert come == pytest.approx(0.018 * 1.85e-4, rel=1e-12)
        assert gone > 0.5 * come


@pytest.mark.parametrize("ranks, mode", [(1, "release"), (2, "release"), (2, "debug")])
def test_restart_is_exact(geldart, tmp_path, ranks, mode):
    end = 0.01 if mode == "release" else 0.004
    run(geldart, "whole", until(end), ranks=ranks, mode=mode, case=BED)
    run(geldart, "parts", until(end / 2), ranks=ranks, mode=mode, case=BED)
    run(geldart, "parts", until(end), restart="parts/restart.h5", ranks=ranks, mode=mode, case=BED)
    same_results(tmp_path / "whole", tmp_path / "parts")


def test_ranks(geldart, tmp_path):
    for ranks in (1, 2, 4):
        run(geldart, f"on{ranks}", *TIGHT, until(0.01), ranks=ranks, case=BED)
    one = state(tmp_path / "on1/restart.h5")
    for ranks in (2, 4):
        other = state(tmp_path / f"on{ranks}/restart.h5")
        for name in ("gas_velocity_1", "gas_velocity_2", "gas_velocity_3", "gas_pressure", "void_fraction"):
            assert np.abs(one[name] - other[name]).max() <= 1e-10 * np.abs(one[name]).max(), (ranks, name)
        assert np.abs(one["parcels"][:, :3] - other["parcels"][:, :3]).max() < 1e-12


def test_density_is_written(geldart, tmp_path):
    """In the file of the gas and by a monitor; not where it is the same everywhere."""
    run(geldart, "out", until(0.01), case=BED)
    fields = data(tmp_path / "out/gas.vtkhdf")
    density, pressure = fields["VTKHDF/CellData/density"], fields["VTKHDF/CellData/pressure"]
    assert density == pytest.approx(PSI * (REFERENCE + pressure.astype(float)), rel=1e-6)
    assert np.ptp(density[-1]) > 1e-4 * density[-1].mean()
    with h5py.File(tmp_path / "out/monitor.h5") as file:
        core = file["monitors/core/gas_density"][-1]
    assert core == pytest.approx(density[-1][:, 0, :].mean(), rel=1e-6)
    run(geldart, "plain", until(0.002))
    assert "VTKHDF/CellData/density" not in data(tmp_path / "plain/gas.vtkhdf")


def test_failed_steps(geldart, tmp_path):
    """Steps that are repeated lose no gas: the density they began with is that of the pressure kept."""
    hasty = ("numerics%maximum_iterations=4", "numerics%velocity_tolerance=1e-6")
    run(geldart, "out", *hasty, until(0.002), case=BED)
    first = mass(tmp_path / "out/restart.h5")
    run(geldart, "out", *hasty, until(0.01), case=BED, restart="out/restart.h5")
    rows = series(tmp_path / "out")
    assert rows["gas_retries"][-1] > 0
    later = rows["time"] > 0.0020001
    net = np.sum((rows["gas_step"] * (rows["gas_inflow"] - rows["gas_outflow"]))[later])
    assert mass(tmp_path / "out/restart.h5") - first == pytest.approx(net, abs=1e-5 * 1.85e-4 * 0.008)

"""The gas step: repeated where it fails, without a trace; chosen by Courant number and iterations."""

import math
import re

import h5py
import numpy as np
import pytest

from conftest import ROOT
from test_runs import data, run, same, series, state, until

RUNS = ROOT / "tests/runs"
LONGEST = {"jump": 2e-3, "collapse": 1e-3, "jet": 2e-3}
# When the gas changes, and how many iterations to aim at, less than at which steps fail.
EVENTS = {"jump": 0.02, "collapse": 0.04, "jet": 0.02}
TARGETS = {"jump": 6, "collapse": 2, "jet": 6}


def adaptive(name):
    return f"numerics%target_iterations={TARGETS[name]}", "numerics%maximum_courant=1"


def retried(rows):
    """Which rows are of steps that had to be repeated."""
    return np.diff(rows["gas_retries"], prepend=0) > 0


def mean_drop(rows):
    return np.average(rows["pressure_drop"][1:], weights=rows["gas_step"][1:])


def books_balance(rows, kept):
    """No parcel, gas or momentum is lost, and the gas has room for all parcels in the end."""
    assert not rows["parcels_lost"].any() and not rows["parcels_left"].any()
    assert np.ptp(rows["parcel_mass"]) <= 1e-13 * rows["parcel_mass"][0]
    assert rows["mass_imbalance"].max() <= 1e-6
    assert rows["exchange_residual"].max() <= 1e-12
    solids = np.sum(np.pi / 6 * kept["parcels"][:, 14] ** 3 * kept["parcels"][:, 15])
    assert np.sum(1 - kept["void_fraction"]) * 0.004**3 == pytest.approx(solids, rel=1e-12)


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("name", EVENTS)
def test_sudden_changes(geldart, tmp_path, name, ranks):
    """Ten times the gas, none, a jet: steps fail and are counted, nothing is lost; fewer fail where steps adapt."""
    case = RUNS / f"{name}.nml"
    done = run(geldart, "plain", case=case, ranks=ranks)
    plain = series(tmp_path / "plain")
    books_balance(plain, state(tmp_path / "plain/restart.h5"))
    around = np.abs(plain["time"] - EVENTS[name]) < 1.5e-3
    assert retried(plain)[around].any()
    counted = float(re.search(r"gas steps repeated +([0-9.E+]+)", done.stdout).group(1))
    assert counted == plain["gas_retries"][-1]

    run(geldart, "adaptive", *adaptive(name), case=case, ranks=ranks)
    rows = series(tmp_path / "adaptive")
    books_balance(rows, state(tmp_path / "adaptive/restart.h5"))
    assert rows["gas_retries"][-1] < plain["gas_retries"][-1]
    assert mean_drop(rows) == pytest.approx(mean_drop(plain), rel=0.01)
    assert rows["gas_step"].max() <= LONGEST[name] * (1 + 1e-9)
    # Too many iterations shorten the next step, where they can.
    long = np.nonzero(rows["gas_iterations"][:-2] > TARGETS[name])[0]
    assert len(long)
    shortest = rows["gas_step"][long] < LONGEST[name] / 2**6 * (1 + 1e-6)
    assert np.all((rows["gas_step"][long + 1] < 0.6 * rows["gas_step"][long]) | shortest)


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("name", EVENTS)
def test_a_failed_try_leaves_no_trace(geldart, tmp_path, name, ranks):
    """A run whose steps fail and are repeated is, bit for bit, one that takes the shorter steps at once."""
    case = RUNS / f"{name}.nml"
    begin, end = EVENTS[name] - LONGEST[name], EVENTS[name] + LONGEST[name]
    short = ("numerics%maximum_halvings=3",)
    run(geldart, "start", *short, "numerics%maximum_iterations=50", until(begin), case=case, ranks=ranks)
    run(geldart, "tried", *short, until(end), restart="start/restart.h5", case=case, ranks=ranks)
    rows = series(tmp_path / "tried")
    repeated = np.nonzero(retried(rows))[0]
    assert len(repeated)

    folder = "start"
    for step in repeated:
        before = float(rows["time"][step - 1])
        if before > begin + 1e-6:
            run(geldart, "known", *short, until(repr(before)), restart=f"{folder}/restart.h5", case=case, ranks=ranks)
            folder = "known"
        with h5py.File(tmp_path / folder / "restart.h5", "r+") as file:
            # Halvings of the next step, and good steps before it: after it there are none.
            file["clock"][2:4] = round(math.log2(LONGEST[name] / rows["gas_step"][step])), -1
    run(geldart, "known", *short, until(end), restart=f"{folder}/restart.h5", case=case, ranks=ranks)
    tried, known = state(tmp_path / "tried/restart.h5"), state(tmp_path / "known/restart.h5")
    assert tried["ledger"][1] >= len(repeated) and known["ledger"][1] == 0
    tried["ledger"][1] = 0
    same(tried, known)


def test_adaptive_steps_restart(geldart, tmp_path):
    """A run with steps that adapt goes on bit for bit, and they are the same on other numbers of ranks."""
    case, options = RUNS / "jet.nml", adaptive("jet")
    run(geldart, "whole", *options, case=case)
    rows = series(tmp_path / "whole")
    settled = np.nonzero((rows["gas_step"] < 0.3e-3) & ~retried(rows) & (rows["time"] > 0.02))[0]
    for step in settled[[1, -1]]:
        run(geldart, "parts", *options, until(repr(float(rows["time"][step]))), case=case, force=True)
        run(geldart, "parts", *options, until(0.04), restart="parts/restart.h5", case=case)
        same(state(tmp_path / "whole/restart.h5"), state(tmp_path / "parts/restart.h5"))
        same(data(tmp_path / "whole/monitor.h5"), data(tmp_path / "parts/monitor.h5"))
    run(geldart, "shared", *options, case=case, ranks=2)
    assert np.array_equal(series(tmp_path / "shared")["time"], rows["time"])


def test_courant_number(geldart, tmp_path):
    """Steps keep below maximum_courant but for the one in which the gas jumps, and are not shorter than they need be."""
    run(geldart, "out", "numerics%maximum_courant=0.4", "numerics%maximum_iterations=50", "output%monitor_interval=2e-3",
        case=RUNS / "jet.nml")
    beats = series(tmp_path / "out")["time"] / LONGEST["jet"]
    assert beats == pytest.approx(np.arange(21), abs=1e-6)  # steps of all lengths end on the beat of the longest
    run(geldart, "all", "numerics%maximum_courant=0.4", "numerics%maximum_iterations=50", case=RUNS / "jet.nml")
    rows = series(tmp_path / "all")
    over = rows["courant"] > 0.4 * 1.05
    assert over.sum() == 1 and rows["time"][over] == pytest.approx(0.02)
    halvings = np.log2(LONGEST["jet"] / rows["gas_step"][1:])
    assert halvings == pytest.approx(np.round(halvings), abs=1e-6)
    assert halvings.max() >= 3 and np.all(np.diff(halvings) > -1.5)
    # Nothing but the beat and the ten steps keeps a step below half of what it may be.
    slack = rows["courant"][1:] < 0.2 / 1.05
    assert np.max(np.diff(np.nonzero(np.concatenate([[True], ~slack | (halvings < 0.5), [True]]))[0])) <= 13


def test_shortest_step(geldart, tmp_path):
    """Not below minimum_time_step, whatever the limits; a run that fails there ends with what it was."""
    options = ("numerics%minimum_time_step=4e-4", "numerics%maximum_courant=0.01")
    run(geldart, "out", *options, "numerics%maximum_iterations=50", until(0.01), case=RUNS / "jump.nml")
    rows = series(tmp_path / "out")
    assert rows["gas_step"][1] == pytest.approx(LONGEST["jump"])  # nothing is known of the first
    assert rows["gas_step"][2:] == pytest.approx(LONGEST["jump"] / 4)
    done = run(geldart, "failed", *options, "numerics%maximum_iterations=1", case=RUNS / "jump.nml", code=3)
    assert "did not converge at t = 0 s, even in steps of 5e-4 s" in done.stderr

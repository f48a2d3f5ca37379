"""Whole runs: the same on any number of ranks, continued exactly, stopped cleanly, never overwritten."""

import signal
import subprocess
import time

import h5py
import numpy as np
import pytest

from conftest import ROOT, program

BED = ROOT / "tests/runs/bed.nml"
TIGHT = ("numerics%tolerance=1e-12", "numerics%velocity_tolerance=1e-12")
# A gas for which some steps are too long, and one for which there is no shorter one.
IMPATIENT = ("numerics%maximum_iterations=2", "numerics%velocity_tolerance=1e-5")
STUBBORN = ("numerics%maximum_iterations=2", "numerics%velocity_tolerance=6e-5", "numerics%maximum_halvings=0")
PATIENT = ("numerics%velocity_tolerance=6e-5",)


def run(geldart, out, *options, restart=None, force=False, ranks=1, code=0, case=BED, mode="release"):
    """Run a case with some keys set ('group%key=value'), to the exit code expected."""
    words = [word for option in options for word in ("--set", option)]
    words += ["--restart", restart] if restart else []
    words += ["--force"] if force else []
    done = geldart(case, "--out", out, *words, ranks=ranks, mode=mode)
    assert done.returncode == code, f"exit {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}"
    return done


def until(end):
    return f"run%end_time={end}"


def state(path):
    """What a restart file holds, parcels sorted by id: {name: array}."""
    with h5py.File(path) as file:
        kept = {name: item[()] for name, item in file.items() if isinstance(item, h5py.Dataset)}
    order = np.argsort(kept["parcel_labels"][:, 0])
    kept["parcels"] = kept["parcels"][order]
    return kept


def data(path):
    """Every data set of a file but wall times, by its path."""
    found = {}

    def keep(name, item):
        if isinstance(item, h5py.Dataset) and "wall_time" not in name:
            found[name] = item[()]

    with h5py.File(path) as file:
        file.visititems(keep)
    return found


def same(a, b):
    """Two sets of arrays are equal to the last bit."""
    assert a.keys() == b.keys()
    for name in a:
        assert np.array_equal(a[name], b[name], equal_nan=a[name].dtype.kind == "f"), f"{name} differs"


def same_results(one, other):
    """So are all files of two runs."""
    same(state(one / "restart.h5"), state(other / "restart.h5"))
    for name in ("parcels.vtkhdf", "gas.vtkhdf", "monitor.h5"):
        same(data(one / name), data(other / name))


def series(folder):
    with h5py.File(folder / "monitor.h5") as file:
        return {name: values[()] for name, values in file["series"].items()}


def test_ranks(geldart, tmp_path):
    """Positions, velocities and the gas on 2 and 4 ranks are those of 1 to 1e-10 of their scale."""
    for ranks in (1, 2, 4):
        run(geldart, f"on{ranks}", *TIGHT, until(0.01), ranks=ranks)
    one = state(tmp_path / "on1/restart.h5")
    for ranks in (2, 4):
        other = state(tmp_path / f"on{ranks}/restart.h5")
        if ranks == 4:
            assert series(tmp_path / "on4")["list_rebuilds"][-1] > 1  # tiles and parcels have changed hands
        for rows in (slice(0, 3), slice(6, 9), slice(9, 12), slice(16, 19)):
            a, b = one["parcels"][:, rows], other["parcels"][:, rows]
            assert np.abs(a - b).max() <= 1e-10 * np.abs(a).max(), (ranks, rows)
        for name in ("gas_velocity_1", "gas_velocity_2", "gas_velocity_3", "gas_pressure", "void_fraction"):
            a, b = one[name], other[name]
            assert np.abs(a - b).max() <= 1e-10 * np.abs(a).max(), (ranks, name)


@pytest.mark.parametrize("ranks, mode", [(1, "release"), (2, "release"), (4, "release"), (2, "debug")])
def test_restart_is_exact(geldart, tmp_path, ranks, mode):
    """A run continued from a restart file is the uninterrupted run, bit for bit, output included."""
    end = 0.02 if mode == "release" else 0.004
    run(geldart, "whole", until(end), ranks=ranks, mode=mode)
    run(geldart, "parts", until(end / 2), ranks=ranks, mode=mode)
    run(geldart, "parts", until(end), restart="parts/restart.h5", ranks=ranks, mode=mode)
    same_results(tmp_path / "whole", tmp_path / "parts")


def test_rolling_restarts(geldart, tmp_path):
    """So are the angles of rolling springs, which are only for runs that have them."""
    rolling = ("contact%rolling=spring", "contact%rolling_friction=0.1")
    run(geldart, "whole", until(0.01), *rolling, ranks=2)
    run(geldart, "parts", until(0.005), *rolling, ranks=2)
    run(geldart, "parts", until(0.01), *rolling, restart="parts/restart.h5", ranks=2)
    same_results(tmp_path / "whole", tmp_path / "parts")
    assert np.abs(state(tmp_path / "whole/restart.h5")["contact_slip"][:, 3:]).max() > 0
    done = run(geldart, "others", until(0.02), restart="parts/restart.h5", code=2)
    assert "the restart file is of a run with a rolling spring, or this case is" in done.stderr


def test_eddies_restart(geldart, tmp_path):
    """So does a gas with eddies smaller than the cells, of which nothing is saved; they make a difference."""
    eddies = ("gas%turbulence_model=smagorinsky", "gas%smagorinsky_constant=0.3")
    run(geldart, "whole", until(0.01), *eddies, ranks=2)
    run(geldart, "parts", until(0.005), *eddies, ranks=2)
    run(geldart, "parts", until(0.01), *eddies, restart="parts/restart.h5", ranks=2)
    same_results(tmp_path / "whole", tmp_path / "parts")
    run(geldart, "without", until(0.01), ranks=2)
    with_eddies, without = (state(tmp_path / name / "restart.h5")["gas_velocity_2"] for name in ("whole", "without"))
    assert np.abs(with_eddies - without).max() > 1e-3 * np.abs(without).max()
    with h5py.File(tmp_path / "whole/gas.vtkhdf") as file:
        viscosity = file["VTKHDF/CellData/eddy_viscosity"][()]
    assert not viscosity[0].any()
    assert (viscosity[1:] >= 0).all()
    assert 1e-6 < viscosity[-1].max() < 1e-2


def test_wide_kernel_restarts(geldart, tmp_path):
    """With a kernel of given width as well."""
    wide = ("coupling%width=0.006",)
    run(geldart, "whole", until(0.01), *wide, ranks=2)
    run(geldart, "parts", until(0.005), *wide, ranks=2)
    run(geldart, "parts", until(0.01), *wide, restart="parts/restart.h5", ranks=2)
    same_results(tmp_path / "whole", tmp_path / "parts")


def test_driven_gas_restarts(geldart, tmp_path):
    """So does the pressure drop that keeps a flow, which then carries the suspension; and an inflow that changes."""
    suspension = ROOT / "tests/runs/suspension.nml"
    run(geldart, "whole", until(0.1), ranks=2, case=suspension)
    run(geldart, "parts", until(0.05), ranks=2, case=suspension)
    run(geldart, "parts", until(0.1), restart="parts/restart.h5", ranks=2, case=suspension)
    same_results(tmp_path / "whole", tmp_path / "parts")
    drop = series(tmp_path / "whole")["periodic_pressure_drop"][-1]
    weight = 9.81 * 2.5e-4 / 0.012**2 + 9.81 * 1.2 * 0.016
    assert drop[1] == pytest.approx(weight, rel=0.02)
    assert np.abs(drop[[0, 2]]).max() < 0.02 * weight

    jump = ("boundary(distributor)%times=0 0.004 0.004", "boundary(distributor)%factors=0.5 1 2")
    run(geldart, "jump", until(0.008), *jump)
    run(geldart, "half", until(0.003), *jump)
    run(geldart, "half", until(0.008), *jump, restart="half/restart.h5")
    same_results(tmp_path / "jump", tmp_path / "half")
    inflow = series(tmp_path / "jump")["gas_inflow"][1:] / (1.2 * 0.6 * 0.016**2)
    assert inflow == pytest.approx([0.625, 0.75, 0.875, 2, 2, 2, 2, 2], rel=1e-12)


def test_restart_on_other_ranks(geldart, tmp_path):
    """Written by 2 ranks, continued by 1 and by 3, as by 2."""
    run(geldart, "first", *TIGHT, until(0.004), ranks=2)
    after = {}
    for ranks in (1, 2, 3):
        run(geldart, f"on{ranks}", *TIGHT, until(0.006), restart="first/restart.h5", ranks=ranks)
        after[ranks] = state(tmp_path / f"on{ranks}/restart.h5")["parcels"][:, :3]
    for ranks in (1, 3):
        assert np.abs(after[ranks] - after[2]).max() < 1e-12


def test_weight_one_is_plain_dem(geldart, tmp_path):
    """Of one size, DEM, SSW with W = 1 and SSP with D = d are one run, bit for bit."""
    case = tmp_path / "one_size.nml"
    text = BED.read_text()
    start = text.index("  distribution")
    text = text[:start] + "  distribution = 'single', mean_diameter = 1.5e-3\n/" + text[text.index("\n&parcels"):]
    case.write_text(text)
    run(geldart, "dem", "parcels%weighting=dem", until(0.005), case=case)
    run(geldart, "ssw", "parcels%weighting=ssw", "parcels%weight=1", until(0.005), case=case)
    run(geldart, "ssp", "parcels%weighting=ssp", "parcels%diameter=1.5e-3", until(0.005), case=case)
    for name in ("ssw", "ssp"):
        same(state(tmp_path / "dem/restart.h5"), state(tmp_path / name / "restart.h5"))


def test_results_stay(geldart, tmp_path):
    """A second run into the same folder needs --force; without it nothing is touched."""
    run(geldart, "out", until(0.002))
    before = {path: path.stat().st_mtime_ns for path in (tmp_path / "out").iterdir()}
    done = run(geldart, "out", until(0.002), code=2)
    assert "--force" in done.stderr
    assert before == {path: path.stat().st_mtime_ns for path in (tmp_path / "out").iterdir()}
    run(geldart, "out", until(0.002), force=True)
    assert series(tmp_path / "out")["time"].tolist() == pytest.approx([0, 0.001, 0.002])


@pytest.mark.parametrize("how", ["limit", "file", "SIGUSR1", "SIGTERM"])
def test_stops_with_a_checkpoint(geldart, tmp_path, how):
    """Out of time, a stop file and a signal end a run with exit 85, and it goes on as if it had not stopped."""
    if how == "limit":
        printed = run(geldart, "parts", until(100), "run%wall_clock_limit=0.2", code=85).stderr
    else:
        command = [str(program("src/geldart")), str(BED), "--out", "parts", "--set", until(100)]
        process = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while not (tmp_path / "parts/monitor.h5").exists():
            time.sleep(0.01)
        time.sleep(0.1)
        if how == "file":
            (tmp_path / "parts/stop").touch()
        else:
            process.send_signal(getattr(signal, how))
        printed = process.communicate(timeout=60)[1]
        assert process.returncode == 85, printed
    assert "--restart parts/restart.h5" in printed
    stopped = state(tmp_path / "parts/restart.h5")["clock"][0]
    assert 0 < stopped < 100
    end = until(round(stopped + 0.01, 4))
    run(geldart, "parts", end, restart="parts/restart.h5")
    run(geldart, "whole", end)
    same_results(tmp_path / "whole", tmp_path / "parts")


def test_no_convergence(geldart, tmp_path):
    """A gas that cannot converge halves its step, then ends with exit 3, and says where and what to try."""
    done = run(geldart, "out", "numerics%maximum_iterations=1", "numerics%maximum_halvings=2", code=3)
    assert "did not converge at t = 0 s, even in steps of 2.5e-4 s" in done.stderr
    assert "time_step" in done.stderr and "out/failed.h5" in done.stderr
    assert (tmp_path / "out/failed.h5").exists() and not (tmp_path / "out/restart.h5").exists()


@pytest.mark.parametrize("ranks", [1, 2])
def test_last_good_state(geldart, tmp_path, ranks):
    """After a step that fails, failed.h5 is what a run that ends before this step leaves; it goes on from there."""
    run(geldart, "start", until(0.005), ranks=ranks)
    done = run(geldart, "failed", *STUBBORN, until(0.1), restart="start/restart.h5", ranks=ranks, code=3)
    assert "--restart" in done.stderr
    when = state(tmp_path / "failed/failed.h5")["clock"][0]
    assert 0.005 < when < 0.1
    run(geldart, "good", *PATIENT, until(when), restart="start/restart.h5", ranks=ranks)
    same(state(tmp_path / "good/restart.h5"), state(tmp_path / "failed/failed.h5"))
    end = until(round(when + 0.01, 4))
    run(geldart, "on", *PATIENT, end, restart="failed/failed.h5", ranks=ranks)
    run(geldart, "whole", *PATIENT, end, restart="start/restart.h5", ranks=ranks)
    same(state(tmp_path / "on/restart.h5"), state(tmp_path / "whole/restart.h5"))


def test_parcels_astray(geldart, tmp_path):
    """Contacts far too soft: exit 3, naming the parcel, the place and the key; the state is kept to be looked at."""
    done = run(geldart, "out", "contact%stiffness=0.01", until(0.2), code=3)
    assert "has gone through a wall" in done.stderr and "&contact stiffness" in done.stderr
    assert "out/failed.h5" in done.stderr and not (tmp_path / "out/restart.h5").exists()


@pytest.mark.parametrize("ranks", [1, 2])
def test_the_first_frame_shows_the_bed(geldart, tmp_path, ranks):
    """What is written before the first step has the void fraction of the parcels put in."""
    run(geldart, "out", until(0.002), ranks=ranks)
    with h5py.File(tmp_path / "out/gas.vtkhdf") as gas, h5py.File(tmp_path / "out/parcels.vtkhdf") as parcels:
        void = gas["VTKHDF/CellData/void_fraction"][0].astype(float)
        first = slice(0, int(parcels["VTKHDF/NumberOfPoints"][0]))
        diameter, weight = (parcels["VTKHDF/PointData"][name][first].astype(float) for name in ("diameter", "weight"))
    assert np.sum(1 - void) * 0.004**3 == pytest.approx(np.sum(np.pi / 6 * weight * diameter**3), rel=1e-5)
    assert series(tmp_path / "out")["least_void_fraction"][0] == pytest.approx(void.min(), rel=1e-6)


@pytest.mark.parametrize("ranks", [1, 2])
def test_halved_steps(geldart, tmp_path, ranks):
    """Steps that converge only when halved are repeated; books, volumes and restarts stay exact."""
    run(geldart, "start", until(0.005), ranks=ranks)
    run(geldart, "whole", *IMPATIENT, until(0.02), restart="start/restart.h5", ranks=ranks)
    rows = series(tmp_path / "whole")
    assert rows["gas_retries"][-1] > 0
    assert rows["gas_step"].min() < 0.6e-3
    assert len(rows["time"]) > 17
    assert np.diff(rows["time"]) == pytest.approx(rows["gas_step"][1:], rel=1e-9)
    assert rows["exchange_residual"].max() <= 1e-12
    assert rows["mass_imbalance"].max() <= 1e-6
    assert not rows["parcels_lost"].any()
    kept = state(tmp_path / "whole/restart.h5")
    solids = np.sum(np.pi / 6 * kept["parcels"][:, 14] ** 3 * kept["parcels"][:, 15])
    cell = 0.004**3
    assert np.sum(1 - kept["void_fraction"]) * cell == pytest.approx(solids, rel=1e-12)
    # The parcels went the way they go in whole steps, but for the error of a step.
    run(geldart, "plain", until(0.02), restart="start/restart.h5", ranks=ranks)
    plain = series(tmp_path / "plain")
    assert rows["mean_height"][-1] == pytest.approx(plain["mean_height"][-1], rel=2e-3)
    # A restart while steps are short, after one that converged at once.
    settled = (rows["gas_step"] < 0.6e-3) & (np.diff(rows["gas_retries"], prepend=0) == 0)
    middle = rows["time"][np.nonzero(settled)[0][3]]
    run(geldart, "parts", *IMPATIENT, until(repr(float(middle))), restart="start/restart.h5", ranks=ranks)
    run(geldart, "parts", *IMPATIENT, until(0.02), restart="parts/restart.h5", ranks=ranks)
    same(state(tmp_path / "parts/restart.h5"), kept)


def test_books(geldart, tmp_path):
    """Nothing is lost, momentum balances to 1e-12 and gas mass to the tolerance, in proportion to it."""
    worst = []
    for tolerance in (1e-4, 1e-6, 1e-9):
        run(geldart, "out", f"numerics%tolerance={tolerance}", force=True, ranks=2)
        rows = series(tmp_path / "out")
        assert not rows["parcels_lost"].any() and not rows["parcels_left"].any()
        assert np.ptp(rows["parcel_mass"]) <= 1e-13 * rows["parcel_mass"][0]
        assert rows["exchange_residual"].max() <= 1e-12
        worst.append(rows["mass_imbalance"].max())
        assert worst[-1] <= tolerance
    assert worst[2] < 1e-4 * worst[0]

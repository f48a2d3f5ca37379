"""Whole runs: the same on any number of ranks, continued exactly, stopped cleanly, never overwritten."""

import signal
import subprocess
import time

import h5py
import numpy as np
import pytest

from conftest import ROOT, program

BED = ROOT / "tests/runs/bed.nml"


def run(geldart, out, *options, ranks=1, code=0, case=BED, mode="release"):
    done = geldart(case, "--out", out, *options, ranks=ranks, mode=mode)
    assert done.returncode == code, f"exit {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}"
    return done


def state(path):
    """What a restart file holds, parcels sorted by id: {name: array}."""
    with h5py.File(path) as file:
        kept = {name: item[()] for name, item in file.items() if isinstance(item, h5py.Dataset)}
    if "parcels" in kept:
        order = np.argsort(kept["parcel_labels"][:, 0])
        kept["parcels"] = kept["parcels"][order]
    return kept


def same_bits(a, b, without=()):
    for name in a:
        if name not in without:
            assert np.array_equal(a[name], b[name]), f"{name} differs"


def test_ranks(geldart, tmp_path):
    """Positions, velocities and the gas on 2 and 4 ranks are those of 1 to 1e-10 of their scale."""
    options = ["--set", "numerics%tolerance=1e-12", "--set", "numerics%velocity_tolerance=1e-12",
               "--set", "run%end_time=0.005"]
    for ranks in (1, 2, 4):
        run(geldart, f"on{ranks}", *options, ranks=ranks)
    one = state(tmp_path / "on1/restart.h5")
    for ranks in (2, 4):
        other = state(tmp_path / f"on{ranks}/restart.h5")
        for rows in (slice(0, 3), slice(6, 9), slice(9, 12), slice(16, 19)):
            a, b = one["parcels"][:, rows], other["parcels"][:, rows]
            assert np.abs(a - b).max() <= 1e-10 * np.abs(a).max(), (ranks, rows)
        for name in ("gas_velocity_1", "gas_velocity_2", "gas_velocity_3", "gas_pressure", "void_fraction"):
            a, b = one[name], other[name]
            assert np.abs(a - b).max() <= 1e-10 * np.abs(a).max(), (ranks, name)


@pytest.mark.parametrize("ranks, mode", [(1, "release"), (2, "release"), (1, "debug")])
def test_restart_is_exact(geldart, tmp_path, ranks, mode):
    """A run continued from a restart file is the uninterrupted run, bit for bit, output included."""
    end = 0.02 if mode == "release" else 0.006
    short = ["--set", f"run%end_time={end / 2}"]
    whole = ["--set", f"run%end_time={end}"]
    run(geldart, "whole", *whole, ranks=ranks, mode=mode)
    run(geldart, "parts", *short, ranks=ranks, mode=mode)
    run(geldart, "parts", *whole, "--restart", "parts/restart.h5", ranks=ranks, mode=mode)
    same_bits(state(tmp_path / "whole/restart.h5"), state(tmp_path / "parts/restart.h5"))
    for name in ("parcels.vtkhdf", "gas.vtkhdf"):
        with h5py.File(tmp_path / "whole" / name) as a, h5py.File(tmp_path / "parts" / name) as b:
            assert np.array_equal(a["VTKHDF/Steps/Values"], b["VTKHDF/Steps/Values"])
            for group in ("PointData", "CellData"):
                for field in a["VTKHDF"].get(group, ()):
                    assert np.array_equal(a["VTKHDF"][group][field], b["VTKHDF"][group][field]), (name, field)
    with h5py.File(tmp_path / "whole/monitor.h5") as a, h5py.File(tmp_path / "parts/monitor.h5") as b:
        for column in a["series"]:
            if not column.startswith("wall_time"):
                assert np.array_equal(a["series"][column], b["series"][column]), column


def test_restart_on_other_ranks(geldart, tmp_path):
    """Written by 2 ranks, continued by 1 and by 3, as by 2."""
    tight = ["--set", "numerics%tolerance=1e-12", "--set", "numerics%velocity_tolerance=1e-12"]
    run(geldart, "first", *tight, "--set", "run%end_time=0.004", ranks=2)
    after = {}
    for ranks in (1, 2, 3):
        run(geldart, f"on{ranks}", *tight, "--set", "run%end_time=0.006", "--restart", "first/restart.h5", ranks=ranks)
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
    for name, options in (("dem", ["parcels%weighting='dem'"]),
                          ("ssw", ["parcels%weighting='ssw'", "parcels%weight=1"]),
                          ("ssp", ["parcels%weighting='ssp'", "parcels%diameter=1.5e-3"])):
        sets = [word for option in [*options, "run%end_time=0.005"] for word in ("--set", option)]
        run(geldart, name, *sets, case=case)
    dem = state(tmp_path / "dem/restart.h5")
    same_bits(dem, state(tmp_path / "ssw/restart.h5"))
    same_bits(dem, state(tmp_path / "ssp/restart.h5"))


def test_results_stay(geldart, tmp_path):
    """A second run into the same folder needs --force; without it nothing is touched."""
    run(geldart, "out", "--set", "run%end_time=0.002")
    before = {path: path.stat().st_mtime_ns for path in (tmp_path / "out").iterdir()}
    done = run(geldart, "out", "--set", "run%end_time=0.002", code=2)
    assert "--force" in done.stderr
    assert before == {path: path.stat().st_mtime_ns for path in (tmp_path / "out").iterdir()}
    run(geldart, "out", "--set", "run%end_time=0.002", "--force")


@pytest.mark.parametrize("how", ["limit", "file", "signal"])
def test_stops_with_a_checkpoint(geldart, tmp_path, how):
    """Out of time, a stop file and a signal end a run with exit 85, and it goes on to the same end."""
    run(geldart, "whole", "--set", "run%end_time=0.1")
    if how == "limit":
        done = run(geldart, "parts", "--set", "run%end_time=0.1", "--set", "run%wall_clock_limit=0.05", code=85)
        printed = done.stderr
    else:
        command = [str(program("src/geldart")), str(BED), "--out", "parts", "--set", "run%end_time=100"]
        process = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while not (tmp_path / "parts/monitor.h5").exists():
            time.sleep(0.01)
        time.sleep(0.2)
        if how == "file":
            (tmp_path / "parts/stop").touch()
        else:
            process.send_signal(signal.SIGUSR1)
        printed = process.communicate(timeout=60)[1]
        assert process.returncode == 85, printed
    assert "--restart" in printed and (tmp_path / "parts/restart.h5").exists()
    with h5py.File(tmp_path / "parts/restart.h5") as file:
        stopped = file["clock"][0]
    if stopped < 0.1:
        run(geldart, "parts", "--set", "run%end_time=0.1", "--restart", "parts/restart.h5")
        same_bits(state(tmp_path / "whole/restart.h5"), state(tmp_path / "parts/restart.h5"))


def test_no_convergence(geldart, tmp_path):
    """A gas that cannot converge halves its step, then ends with exit 3, a message and the last good state."""
    done = run(geldart, "out", "--set", "numerics%maximum_iterations=1", "--set", "numerics%maximum_halvings=2", code=3)
    assert "did not converge at t = 0" in done.stderr and "time_step" in done.stderr
    assert (tmp_path / "out/failed.h5").exists() and not (tmp_path / "out/restart.h5").exists()


def test_books(geldart, tmp_path):
    """What is printed at the end of every run: nothing lost, momentum to 1e-12, gas mass to the tolerance."""
    for tolerance in (1e-4, 1e-6, 1e-9):
        run(geldart, "out", "--force", "--set", f"numerics%tolerance={tolerance}", ranks=2)
        with h5py.File(tmp_path / "out/monitor.h5") as file:
            series = file["series"]
            assert np.all(series["parcels_lost"][()] == 0)
            assert series["exchange_residual"][()].max() <= 1e-12
            assert series["mass_imbalance"][()].max() <= tolerance

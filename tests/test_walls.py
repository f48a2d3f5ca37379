"""Runs in a turning drum: no parcel is lost, ranks and restarts make no difference, mistakes are told."""

import h5py
import numpy as np
import pytest

from conftest import ROOT

DRUM = ROOT / "tests/runs/drum.nml"


def state(path):
    """What a restart file holds: {name: array}."""
    with h5py.File(path) as file:
        return {name: item[()] for name, item in file.items() if isinstance(item, h5py.Dataset)}


def sorted_parcels(path):
    kept = state(path)
    return kept["parcels"][np.argsort(kept["parcel_labels"][:, 0])]


def run(geldart, *arguments, code=0, **keywords):
    done = geldart(DRUM, *arguments, **keywords)
    assert done.returncode == code, f"exit {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}"
    return done


def test_drum(geldart, tmp_path):
    """All parcels stay between the drum and the rod, and the drum carries the heap up: turning about +z, to higher x."""
    run(geldart, "--out", "long", "--set", "run%end_time=0.3")
    parcels = sorted_parcels(tmp_path / "long/restart.h5")
    assert len(parcels) == 600
    x, y = parcels[:, 0] - 0.016, parcels[:, 1] - 0.016
    assert np.hypot(x, y).max() < 0.0155 - 0.45e-3
    assert np.hypot(x, y - 0.002).min() > 0.0035
    assert x.mean() > 2e-3


def test_ranks(geldart, tmp_path):
    for ranks in (1, 2, 4):
        run(geldart, "--out", f"on{ranks}", "--set", "run%end_time=0.01", ranks=ranks)
    one = sorted_parcels(tmp_path / "on1/restart.h5")
    for ranks in (2, 4):
        other = sorted_parcels(tmp_path / f"on{ranks}/restart.h5")
        assert np.abs(other[:, :3] - one[:, :3]).max() < 1e-10 * 0.03, ranks


@pytest.mark.parametrize("ranks, mode", [(1, "release"), (2, "release"), (2, "debug")])
def test_restart_is_exact(geldart, tmp_path, ranks, mode):
    end = 0.05 if mode == "release" else 0.03
    run(geldart, "--out", "whole", "--set", f"run%end_time={end}", ranks=ranks, mode=mode)
    run(geldart, "--out", "parts", "--set", f"run%end_time={end / 2}", ranks=ranks, mode=mode)
    run(geldart, "--out", "parts", "--set", f"run%end_time={end}", "--restart", "parts/restart.h5", ranks=ranks, mode=mode)
    whole, parts = state(tmp_path / "whole/restart.h5"), state(tmp_path / "parts/restart.h5")
    assert (whole["contact_partner"] < -6).any()
    for name in whole:
        assert np.array_equal(whole[name], parts[name]), f"{name} differs"


def test_file_beyond_wall(geldart, tmp_path):
    """A parcel of a file that starts outside the drum is a mistake of the user, not a failure of the run."""
    (tmp_path / "two.csv").write_text("x,y,z,d\n0.016,0.008,0.006,1e-3\n0.001,0.001,0.006,1e-3\n")
    text = DRUM.read_text()
    start = text.index("number = 600")
    case = tmp_path / "case.nml"
    case.write_text(text[:start] + "file = 'two.csv' /\n" + text[text.index("&contact"):])
    done = geldart(case, "--out", "results")
    assert done.returncode == 2
    assert "&fill(heap): its parcel at 0.001, 0.001, 0.006 m is beyond a &wall, or in one" in done.stderr
    assert not (tmp_path / "results").exists()


def test_description(geldart):
    done = run(geldart, "--check")
    assert "drum: cylinder, parcels inside, turning at 15 rad/s" in done.stdout
    assert "rod: cylinder 0.01 m long" in done.stdout

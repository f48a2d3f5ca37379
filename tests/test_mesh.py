"""Runs in vessels made of triangles: no parcel is lost, format, ranks and restarts make no difference, mistakes are told."""

import h5py
import numpy as np
import pytest

import stl
from conftest import ROOT
from test_output import field, steps_of, vtk_to_numpy

MILL = (ROOT / "tests/runs/mesh.nml").read_text()
BLADES = 4


def state(path):
    """What a restart file holds: {name: array}."""
    with h5py.File(path) as file:
        return {name: item[()] for name, item in file.items() if isinstance(item, h5py.Dataset)}


def sorted_parcels(path):
    kept = state(path)
    return kept["parcels"][np.argsort(kept["parcel_labels"][:, 0])]


@pytest.fixture
def run(geldart, tmp_path):
    """run(*options) computes the mill in the test's folder and returns what it printed."""
    (tmp_path / "case.nml").write_text(MILL)
    stl.write_binary(tmp_path / "mill.stl", stl.drum(14, 16, 48, BLADES, 3))

    def launch(*options, code=0, **keywords):
        done = geldart("case.nml", *options, **keywords)
        assert done.returncode == code, f"exit {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}"
        return done

    return launch


def test_mill(run, tmp_path):
    """All parcels stay in the mill, and it carries the heap up: turning about +y, from low z to low x."""
    run("--set", "run%end_time=0.25")
    parcels = sorted_parcels(tmp_path / "results/restart.h5")
    assert len(parcels) == 500
    x, y, z = parcels[:, :3].T
    assert np.hypot(x, z).max() < 14e-3 - 0.45e-3
    assert np.abs(y).max() < 8e-3 - 0.45e-3
    assert x.mean() < -2e-3


def test_text_is_binary(run, tmp_path):
    """The same triangles as a text, and in a binary file that begins with 'solid', make the same run."""
    run("--out", "binary", "--set", "run%end_time=0.01")
    stl.write_text(tmp_path / "mill.stl", stl.drum(14, 16, 48, BLADES, 3))
    run("--out", "text", "--set", "run%end_time=0.01")
    stl.write_binary(tmp_path / "mill.stl", stl.drum(14, 16, 48, BLADES, 3), b"solid, but binary")
    run("--out", "solid", "--set", "run%end_time=0.01")
    for other in ("text", "solid"):
        assert np.array_equal(sorted_parcels(tmp_path / "binary/restart.h5"), sorted_parcels(tmp_path / other / "restart.h5")), other


def test_ranks(run, tmp_path):
    for ranks in (1, 2, 4):
        run("--out", f"on{ranks}", "--set", "run%end_time=0.01", ranks=ranks)
    one = sorted_parcels(tmp_path / "on1/restart.h5")
    for ranks in (2, 4):
        other = sorted_parcels(tmp_path / f"on{ranks}/restart.h5")
        assert np.abs(other[:, :3] - one[:, :3]).max() < 1e-10 * 0.03, ranks


@pytest.mark.parametrize("ranks, mode", [(1, "release"), (2, "release"), (2, "debug")])
def test_restart_is_exact(run, tmp_path, ranks, mode):
    end = 0.05 if mode == "release" else 0.03
    run("--out", "whole", "--set", f"run%end_time={end}", ranks=ranks, mode=mode)
    run("--out", "parts", "--set", f"run%end_time={end / 2}", ranks=ranks, mode=mode)
    run("--out", "parts", "--set", f"run%end_time={end}", "--restart", "parts/restart.h5", ranks=ranks, mode=mode)
    whole, parts = state(tmp_path / "whole/restart.h5"), state(tmp_path / "parts/restart.h5")
    assert (whole["contact_partner"] < -6).any()
    for name in whole:
        assert np.array_equal(whole[name], parts[name]), f"{name} differs"


@pytest.mark.parametrize("ranks", [1, 2])
def test_vtk_sees_it_turn(run, tmp_path, ranks):
    """walls.vtkhdf has the triangles where they are at every output time, also of a run that was continued."""
    options = ["--set", "output%parcels_interval=0.005", "--set"]
    run(*options, "run%end_time=0.012", ranks=ranks)
    run(*options, "run%end_time=0.02", "--restart", "results/restart.h5", ranks=ranks)
    times, data_at = steps_of(tmp_path / "results/walls.vtkhdf")
    assert np.allclose(times, [0, 0.005, 0.01, 0.015, 0.02])
    still = 1e-3 * stl.drum(14, 16, 48, BLADES, 3).reshape(-1, 3)
    for time in times:
        mill = data_at(time)
        assert mill.GetNumberOfPolys() == 200
        angle = 15 * time
        x, y, z = still.T
        turned = np.stack([x * np.cos(angle) + z * np.sin(angle), y, z * np.cos(angle) - x * np.sin(angle)], axis=1)
        assert np.allclose(vtk_to_numpy(mill.GetPoints().GetData()), turned, atol=1e-8)
        assert (field(mill.GetCellData(), "wall") == 1).all()
    assert [vtk_to_numpy(mill.GetPolys().GetConnectivityArray())[k] for k in (0, 1, 599)] == [0, 1, 599]


@pytest.mark.parametrize("friction", [0, 0.5])
def test_periodic_floor(geldart, tmp_path, friction):
    """On a floor of two triangles from end to end of a periodic domain parcels slide and roll as on the face below it."""
    text = """
&run end_time = 0.3 /
&domain lower = 0, 0, -0.01, upper = 0.02, 0.01, 0.02, periodic = t, t, f, gravity = 2, 1, -9.81 /
&powder id = 'glass', density = 2500, distribution = 'single', mean_diameter = 1e-3 /
&parcels /
&fill id = 'row', powder = 'glass', file = 'row.csv' /
&contact stiffness = 200, restitution = 0.5, friction = %g /
""" % friction
    (tmp_path / "row.csv").write_text("x,y,z,d\n" + "".join(f"{0.002 + 0.004 * k},{0.001 + 0.002 * k},0.0007,1e-3\n" for k in range(4)))
    (tmp_path / "face.nml").write_text(text.replace("-0.01, upper", "0, upper"))
    (tmp_path / "mesh.nml").write_text(text + "&wall id = 'floor', kind = 'mesh', file = 'floor.stl', open = true /\n")
    floor = np.array([[(0, 0, 0), (0.02, 0, 0), (0.02, 0.01, 0)], [(0, 0, 0), (0.02, 0.01, 0), (0, 0.01, 0)]])
    stl.write_text(tmp_path / "floor.stl", floor)
    for name in ("face", "mesh"):
        done = geldart(f"{name}.nml", "--out", name, "--set", "output%progress=none")
        assert done.returncode == 0, done.stderr
    face, mesh = (sorted_parcels(tmp_path / name / "restart.h5") for name in ("face", "mesh"))
    way = face[:, :3] - mesh[:, :3]
    way[:, :2] -= np.round(way[:, :2] / [0.02, 0.01]) * [0.02, 0.01]
    assert np.abs(way).max() < 1e-9
    assert np.abs(face[:, 6]).min() > 0.2


def test_beyond(run, tmp_path):
    """A parcel of a file that starts in a triangle is a mistake of the user, not a failure of the run."""
    (tmp_path / "two.csv").write_text("x,y,z,d\n0,0,-0.008,1e-3\n0,0.0079,0,1e-3\n")
    start = MILL.index("number = 500")
    (tmp_path / "case.nml").write_text(MILL[:start] + "file = 'two.csv' /\n" + MILL[MILL.index("&contact"):])
    done = run(code=2)
    assert "&fill(heap): its parcel at 0, 0.0079, 0 m is beyond a &wall, or in one" in done.stderr
    assert not (tmp_path / "results").exists()


@pytest.mark.parametrize("ranks", [1, 2])
def test_mistakes(run, tmp_path, ranks):
    stl.write_binary(tmp_path / "mill.stl", stl.drum(14, 16, 48)[1:])
    done = run("--set", "wall%open=false", code=2, ranks=ranks)
    assert "is not closed: 3 edges have a triangle on one side only" in done.stderr
    (tmp_path / "mill.stl").write_bytes(b"\0" * 200)
    done = run(code=2, ranks=ranks)
    assert "with the 0 triangles it announces it would be 84 bytes long, not 200" in done.stderr


def test_description(run):
    done = run("--check")
    assert "mill: mesh of 200 triangles, open, 0.028 by 0.016 by 0.028 m, from mill.stl, turning at 15 rad/s" in done.stdout

"""A bed in a cylinder that cuts the cells of the gas: the vessel is as large as it should be, nothing is lost in it."""

import h5py
import numpy as np
import pytest

import stl
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


# A hopper on a tube, of 32 triangles round each, open below and above: as it stands in the case, or 20 mm longer at either end.
WIDE, NARROW, SEGMENTS = 0.02, 0.012, 32
OFFSET = "file = 'hopper.stl', scale = 1e-3, offset = 0.022, 0, 0.022, gas_side = 'inside' /"
ABOVE = {"mass = 0.045, lower = 0.0085, 0,": "mass = 0.02, lower = 0.0085, 0.035,"}


def side(radii, heights):
    """The side of a truncated cone along y, in mm."""
    angles = 2 * np.pi * np.arange(SEGMENTS + 1) / SEGMENTS
    angles[-1] = 0
    rings = [np.stack([1e3 * r * np.cos(angles), np.full(SEGMENTS + 1, 1e3 * y), 1e3 * r * np.sin(angles)], axis=1)
             for r, y in zip(radii, heights, strict=True)]
    triangles = []
    for k in range(SEGMENTS):
        a, b, c, d = rings[0][k], rings[0][k + 1], rings[1][k + 1], rings[1][k]
        triangles += [(a, b, c), (a, c, d)]
    return np.array(triangles)


def hopper(beyond):
    parts = [side((NARROW, WIDE), (0, 0.03)), side((WIDE, WIDE), (0.03, 0.16 + beyond))]
    if beyond:
        parts.append(side((NARROW, NARROW), (-beyond, 0)))
    return np.concatenate(parts)


@pytest.fixture
def mesh_case(tmp_path):
    """The case with another wall: mesh_case(wall, triangles, **replacements) writes case.nml and hopper.stl."""

    def write(wall, triangles, **keys):
        text = CASE.read_text()
        old = next(line for line in text.splitlines() if line.startswith("&wall"))
        text = text.replace(old, "&wall id = 'vessel', kind = 'mesh', " + wall)
        for old, new in keys.items():
            assert text.count(old) > 0, old
            text = text.replace(old, new)
        (tmp_path / "case.nml").write_text(text)
        stl.write_binary(tmp_path / "hopper.stl", triangles)

    return write


@pytest.mark.parametrize("beyond, ranks", [(0, 1), (0.02, 2)])
def test_open_mesh(geldart, mesh_case, tmp_path, beyond, ranks):
    """A hopper whose rims are on the faces of the domain, or beyond, holds the bed and lets the gas through; its volume is that of
    its triangles."""
    mesh_case(OFFSET, hopper(beyond), **ABOVE)
    done = geldart("case.nml", "--set", "run%end_time=0.02", "--set", "output%gas_interval=0.02", "--set", "numerics%tolerance=1e-8",
                   ranks=ranks)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "warning" not in done.stdout
    with h5py.File(tmp_path / "results/monitor.h5") as file:
        series = {name: values[()] for name, values in file["series"].items()}
    assert not series["parcels_lost"].any() and not series["parcels_left"].any()
    section = SEGMENTS / 2 * np.sin(2 * np.pi / SEGMENTS)
    volume = section * (WIDE**2 * 0.13 + (WIDE**2 + WIDE * NARROW + NARROW**2) * 0.01)
    with h5py.File(tmp_path / "results/gas.vtkhdf") as file:
        cells = {name: values[-1].astype(float) for name, values in file["VTKHDF/CellData"].items()}
    assert (cells["open_fraction"] * 0.004**3).sum() == pytest.approx(volume, rel=0.01)
    # the inflow is by velocity, through the narrow rim
    assert series["gas_inflow"][-1] == pytest.approx(1.2 * 0.5 * section * NARROW**2, rel=0.03)
    assert series["gas_outflow"][-1] == pytest.approx(series["gas_inflow"][-1], rel=1e-3)
    assert series["exchange_residual"].max() < 1e-12


def test_bed_in_mesh_is_that_in_cylinder(geldart, mesh_case, runs, tmp_path):
    """In a tube of triangles, open at both faces, the bed's pressure drop and height are those in the cylinder."""
    mesh_case(OFFSET, side((0.02, 0.02), (0, 0.16)))
    done = geldart("case.nml", "--set", "run%end_time=0.02")
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(tmp_path / "results/monitor.h5") as file:
        for name, near in (("pressure_drop", 0.03), ("bed_height", 0.01), ("gas_inflow", 0.01)):
            assert file["series"][name][-1] == pytest.approx(runs[1][name][-1], rel=near), name


def test_mistakes_of_open_meshes(geldart, mesh_case, tmp_path):
    """A rim in the domain; joined faces that the mesh meets in different places; nothing left to the gas; gas that cannot leave."""
    told = "its file has a rim at"
    mesh_case(OFFSET, side((0.02, 0.02), (0, 0.15)))
    done = geldart("case.nml")
    assert done.returncode == 2 and told in done.stderr, done.stderr
    edges = {"gravity =": "periodic = f, t, f, gravity =", "&boundary id = 'distributor', kind = 'inflow', velocity = 0.5":
             "&boundary id = 'distributor', kind = 'slip'", "lower = 0, 0, 0, upper = 0.044, 0, 0.044 /":
             "lower = 0, 0, 0, upper = 0, 0.16, 0.044 /", "kind = 'outflow', pressure = 0, lower = 0, 0.16, 0":
             "kind = 'slip', lower = 0.044, 0, 0"}
    mesh_case(OFFSET, hopper(0), **ABOVE, **edges)
    done = geldart("case.nml")
    assert done.returncode == 2, done.stderr
    assert "the walls leave different parts of the two faces across y to the gas, and these are joined" in done.stderr
    mesh_case(OFFSET, side((0.04, 0.04), (0, 0.16)))
    done = geldart("case.nml")
    assert done.returncode == 2 and "all of its file lies on or beyond faces of the domain" in done.stderr, done.stderr
    mesh_case(OFFSET, 1e3 * stl.drum(0.0005, 0.02, 12) + [0, 100, 0])
    done = geldart("case.nml")
    assert done.returncode == 2 and "the walls leave no cell to the gas: see gas_side of &wall" in done.stderr, done.stderr
    mesh_case(OFFSET, side((0.02, 0.02), (0, 0.16)), **{"0.16, 0, upper = 0.044, 0.16, 0.044": "0.16, 0, upper = 0.005, 0.16, 0.005"})
    done = geldart("case.nml")
    assert done.returncode == 2 and "holds the centre of no cell face" in done.stderr, done.stderr
    assert not (tmp_path / "results").exists()


def test_pocket(geldart, mesh_case, tmp_path):
    """A part of the domain that walls keep from the outflow is told of and closed."""
    shell = np.concatenate([1e3 * stl.drum(0.008, 0.03, 24), 1e3 * stl.drum(0.004, 0.02, 24)]) + [0, 100, 0]
    mesh_case(OFFSET.replace("inside", "outside"), shell, **{"cells = 11, 40, 11": "cells = 22, 80, 22"})
    done = geldart("case.nml", "--set", "run%end_time=0.002")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "warning: 1 parts of the domain with" in done.stdout
    assert "have no way to an outflow and are closed to the gas" in done.stdout

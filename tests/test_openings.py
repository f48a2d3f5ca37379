"""Openings in faces of the domain: parcels leave through them and nowhere else."""

import h5py
import numpy as np
import pytest

from test_walls import sorted_parcels, state

DIAMETER, STIFFNESS, RESTITUTION = 1e-3, 2000, 0.8
CASE = """
&run end_time = %g /
&domain lower = 0, 0, 0, upper = 0.02, 0.02, 0.01, periodic = %s, gravity = %s /
&powder id = 'glass', density = 2500, distribution = 'single', mean_diameter = 1e-3 /
&parcels /
&fill id = 'grains', powder = 'glass', file = 'grains.csv' /
&contact stiffness = %g, restitution = %g, friction = %g /
"""


def region(name, lower, upper, parcels="open"):
    corners = [", ".join(f"{x:.17g}" for x in corner) for corner in (lower, upper)]
    return f"&boundary id = '{name}', lower = {corners[0]}, upper = {corners[1]}, parcels = '{parcels}' /\n"


@pytest.fixture
def run(geldart, tmp_path):
    """run(places, *regions) lets parcels fall from there and returns those that are left, [x, y, z, ...] in the order of their
    numbers, and the numbers."""

    def launch(places, *regions, end=0.08, periodic="f, f, f", gravity="0, 0, -9.81", friction=0, stiffness=STIFFNESS, out="results",
               ranks=1, mode="release"):
        rows = "".join(f"{x:.17g},{y:.17g},{z:.17g},{DIAMETER}\n" for x, y, z in places)
        (tmp_path / "grains.csv").write_text("x,y,z,d\n" + rows)
        (tmp_path / "case.nml").write_text(CASE % (end, periodic, gravity, stiffness, RESTITUTION, friction) + "".join(regions))
        done = geldart("case.nml", "--out", out, "--force", "--set", "output%progress=none", ranks=ranks, mode=mode)
        assert done.returncode == 0, done.stderr
        with h5py.File(tmp_path / out / "restart.h5") as file:
            numbers = np.sort(file["parcel_labels"][:, 0])
        return sorted_parcels(tmp_path / out / "restart.h5"), numbers

    return launch


def lattice(n, height):
    """Places in a plane over the floor, apart by more than a diameter and off the walls."""
    x = 0.001 + 0.018 * (np.arange(n) + 0.5) / n
    return np.array([(a, b, height) for b in x for a in x])


@pytest.mark.parametrize("ranks, mode", [(1, "release"), (2, "release"), (2, "debug")])
def test_hole(run, ranks, mode):
    """Falling straight down without friction, who is over the hole leaves, and who is beside it stays where it is."""
    hole = [(0.0051, 0.0062, 0), (0.0123, 0.0141, 0)]
    places = lattice(14, 0.004)
    parcels, numbers = run(places, region("hole", *hole), ranks=ranks, mode=mode)
    inside = ((places[:, :2] > hole[0][:2]) & (places[:, :2] < hole[1][:2])).all(axis=1)
    assert inside.sum() > 20
    assert set(numbers) == set(np.flatnonzero(~inside) + 1)
    assert np.abs(parcels[:, :2] - places[numbers - 1, :2]).max() < 1e-12


@pytest.mark.parametrize("aside", [-0.0003, 0.0003])
def test_edge(run, aside):
    """A ball that falls on the edge of an opening from the open side is thrown into it: e times its speed along the way from the
    edge, and all of it across. From the other side it falls flat."""
    height, wait = 0.003, 0.001
    drop = np.sqrt((DIAMETER / 2) ** 2 - max(aside, 0) ** 2)
    speed = np.sqrt(2 * 9.81 * (height - drop))
    parcels, _ = run([(0.01 + aside, 0.012, height)], region("half", (0.01, 0, 0), (0.02, 0.02, 0)), end=speed / 9.81 + wait,
                     stiffness=1e6)
    normal = np.array([max(aside, 0), drop]) / (DIAMETER / 2)
    after = np.array([0, -speed]) + (1 + RESTITUTION) * speed * normal[1] * normal - [0, 9.81 * wait]
    assert np.abs(parcels[0, [6, 8]] - after).max() < 5e-3 * speed
    assert abs(parcels[0, 7]) < 1e-12


def test_rest_of_face(run):
    """Beside an opening a face is what it is without one."""
    x = 0.0015 + 0.003 * np.arange(4)
    places = np.array([(a, 0.002 + 0.7 * a, 0.0008) for a in x])
    keywords = {"gravity": "0.5, 0.3, -9.81", "friction": 0.4}
    far = region("far", (0.0187, 0.0, 0), (0.02, 0.0011, 0))
    whole, _ = run(places, out="whole", **keywords)
    rest, _ = run(places, far, out="rest", **keywords)
    assert np.abs(whole[:, :3] - rest[:, :3]).max() < 1e-9
    assert np.abs(whole[:, 0] - x).min() > 5e-4


def test_slot(run):
    """A slot narrower than a parcel carries it on both edges; one just wider does not."""
    for width, stays in ((0.0007, 1), (0.00101, 0)):
        slot = region("slot", (0.01 - width / 2, 0, 0), (0.01 + width / 2, 0.02, 0))
        parcels, numbers = run([(0.01, 0.012, 0.001)], slot, end=0.2)
        assert len(numbers) == stays
    parcels, _ = run([(0.01, 0.012, 0.001)], region("slot", (0.00965, 0, 0), (0.01035, 0.02, 0)), end=0.2)
    # At rest two springs, one on either edge, bear the weight.
    height = np.sqrt(0.0005**2 - 0.00035**2)
    weight = 2500 * np.pi / 6 * DIAMETER**3 * 9.81
    overlap = weight / 2 / (height / 0.0005) / STIFFNESS
    assert abs(parcels[0, 0] - 0.01) < 1e-12
    assert abs(parcels[0, 2] - height + overlap / (height / 0.0005)) < 0.02 * overlap


def test_several(run):
    """Two openings of a floor and one of a side; a face that they cover as a whole is gone."""
    places = lattice(10, 0.004)
    left_half, right_half = (region(name, (x, 0, 0), (x + 0.01, 0.02, 0)) for name, x in (("left", 0), ("right", 0.01)))
    _, numbers = run(places, left_half, right_half)
    assert len(numbers) == 0
    corner = region("corner", (0, 0, 0), (0.005, 0.005, 0))
    _, numbers = run(places, corner, right_half)
    gone = (places[:, 0] > 0.01) | (places[:, :2] < 0.005).all(axis=1)
    assert set(numbers) == set(np.flatnonzero(~gone) + 1)
    door = region("door", (0, 0.005, 0), (0, 0.0151, 0.01))
    rolling, numbers = run(places, door, gravity="-9.81, 0, 0", end=0.15)
    gone = (places[:, 1] > 0.005) & (places[:, 1] < 0.0151)
    assert set(numbers) == set(np.flatnonzero(~gone) + 1)


def test_periodic(run):
    """An opening that ends at a periodic face has its edge there for parcels on the other side."""
    opening = region("opening", (0.01, 0, 0), (0.02, 0.02, 0))
    near = [(0.02 - 0.0003, 0.012, 0.003), (0.01 + 0.0003, 0.006, 0.003)]
    parcels, numbers = run(near, opening, periodic="t, f, f", end=0.0248)
    assert len(numbers) == 2
    velocity = parcels[:, 6:9]
    assert np.abs(velocity[0] * [-1, 1, 1] - velocity[1]).max() < 1e-9
    assert velocity[1, 0] > 0.1


@pytest.mark.parametrize("mode", ["release", "debug"])
def test_restart_is_exact(run, geldart, tmp_path, mode):
    opening = region("opening", (0.004, 0, 0), (0.0137, 0.0138, 0))
    keywords = {"gravity": "0.5, 0.3, -9.81", "friction": 0.4, "mode": mode}
    run(lattice(6, 0.001), opening, out="whole", end=0.2, **keywords)
    run(lattice(6, 0.001), opening, out="parts", end=0.1, **keywords)
    done = geldart("case.nml", "--out", "parts", "--set", "run%end_time=0.2", "--restart", "parts/restart.h5",
                   "--set", "output%progress=none", mode=mode)
    assert done.returncode == 0, done.stderr
    whole, parts = state(tmp_path / "whole/restart.h5"), state(tmp_path / "parts/restart.h5")
    assert 0 < len(whole["parcels"]) < 36
    assert (whole["contact_partner"] < -6).any()
    for name in whole:
        assert np.array_equal(whole[name], parts[name]), f"{name} differs"

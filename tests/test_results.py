"""What the cases' scripts share: statistics and bubbles, against cases that are known."""

import sys

import numpy as np
import pytest

from conftest import ROOT

sys.path.insert(0, str(ROOT / "cases"))
import fluidization  # noqa: E402
import results  # noqa: E402


def test_error_of_a_mean_of_noise():
    """Independent samples: sigma/sqrt(n), and the largest of five estimates lies a little above."""
    noise = np.random.default_rng(1).normal(3.0, 2.0, (200, 400))
    found = np.array([results.mean_with_error(series) for series in noise])
    assert np.mean(found[:, 0]) == pytest.approx(3.0, abs=0.02)
    assert 1.0 < np.mean(found[:, 1]) / (2.0 / np.sqrt(400)) < 1.6


def test_error_of_a_mean_with_memory():
    """Samples that come in equal runs of ten carry a tenth of the information: sqrt(10) times the error."""
    noise = np.repeat(np.random.default_rng(2).normal(0.0, 1.0, (200, 40)), 10, axis=1)
    errors = [results.mean_with_error(series)[1] for series in noise]
    assert 1.0 < np.mean(errors) / (1.0 / np.sqrt(40)) < 1.6


def test_log_normal_moments():
    """Clipped far out, the number mean, Sauter and mass mean are m, m (1+c^2)^2 and m (1+c^2)^3."""
    mean, c = 500e-6, 0.25
    sizes, number, mass = results.log_normal_by_number(mean, c * mean, 50e-6, 5e-3, points=40001)
    middle = (sizes[1:] + sizes[:-1]) / 2
    found = results.means(middle, np.diff(number))
    assert found == pytest.approx([mean, mean * (1 + c**2) ** 2, mean * (1 + c**2) ** 3], rel=1e-5)
    assert np.sum(middle * np.diff(mass)) == pytest.approx(mean * (1 + c**2) ** 3, rel=1e-5)


def test_regions():
    picture = ["##..#", "#...#", "..#.#", "....#"]
    labels, number = results.regions(np.array([[c == "#" for c in row] for row in picture]))
    assert number == 3
    assert labels[0, 0] == labels[1, 0] != labels[2, 2] != labels[0, 4] == labels[3, 4]
    assert labels[3, 0] == 0


def test_bubbles_are_followed():
    """One bubble that rises by 4 mm per frame of 10 ms under a freeboard, and one that appears late."""
    sys.path.insert(0, str(ROOT / "cases/geldart_b_bed"))
    from validate import Bubbles

    class Gas:
        count = 5
        times = 0.01 * np.arange(count)
        h = np.array([4e-3, 4e-3, 4e-3])
        lower = np.zeros(3)
        centres = results.Gas.centres
        cells = np.array([16, 30, 1])

        def __call__(self, name, step):
            eps = np.full((1, 30, 16), 0.45)
            eps[:, 25:] = 1.0
            eps[:, 5 + step : 8 + step, 2:6] = 0.9
            if step > 2:
                eps[:, 4:7, 11:14] = 0.9
            return eps

    bubbles = Bubbles(Gas(), 0)
    assert bubbles.seen == 2
    assert bubbles.frames_with == 5
    assert np.max(bubbles.speeds) == pytest.approx(0.4)
    assert np.max(bubbles.sizes) == pytest.approx(np.sqrt(4 / np.pi * 12) * 4e-3)


def test_velocity_that_carries_a_powder():
    """75 um, 1500 kg/m3 and 1.2 mm, 1000 kg/m3 at a void fraction of 0.42, by two laws, computed elsewhere."""
    fine, coarse = ((np.array([d]), np.array([3.0])) for d in (75e-6, 1.2e-3))
    for powder, solid, law, expected in ((fine, 1500, fluidization.gidaspow, 0.003911294561),
                                         (fine, 1500, fluidization.beetstra, 0.003223642369),
                                         (coarse, 1000, fluidization.gidaspow, 0.4043809163),
                                         (coarse, 1000, fluidization.beetstra, 0.3837603358)):
        assert fluidization.carrying_velocity(0.42, powder, solid, law) == pytest.approx(expected, rel=1e-9)


def test_crossing_of_a_packed_bed():
    """2 U + 3 U^2 is 1 at a third; a straight line, too."""
    u = np.array([0.05, 0.1, 0.2])
    assert fluidization.crossing(u, 2 * u + 3 * u**2) == pytest.approx([1 / 3, 2, 3])
    assert fluidization.crossing(u, 4 * u)[0] == pytest.approx(0.25)

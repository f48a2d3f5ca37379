"""Runs of several materials: ranks, restarts and the names of materials make no difference; equal materials are one."""

import h5py
import numpy as np
import pytest

from conftest import ROOT

MIXTURE = ROOT / "tests/runs/mixture.nml"

# Rolling springs and attraction of the mixture: rubber has neither.
SEPARATIONS = ("contact%minimum_separation=1e-7", "contact%maximum_separation=1e-5")
EFFECTS = [word for setting in (
    "contact%rolling=spring",
    "contact%rolling_damping=0.5",
    "material(glass)%rolling_friction=0.05",
    "material(glass)%rolling_damping=0.2",
    "material(steel)%rolling_friction=0.2",
    "material(rubber)%rolling_friction=0",
    "material_pair(1)%rolling_friction=0.3",
    "contact%cohesion=van_der_waals",
    *SEPARATIONS,
    "material(glass)%hamaker_constant=1e-15",
    "material(steel)%hamaker_constant=4e-15",
    "material(rubber)%hamaker_constant=0",
    "material_pair(1)%hamaker_constant=3e-15",
) for word in ("--set", setting)]


def state(path):
    """What a restart file holds: {name: array}."""
    with h5py.File(path) as file:
        return {name: item[()] for name, item in file.items() if isinstance(item, h5py.Dataset)}


def sorted_parcels(path):
    kept = state(path)
    return kept["parcels"][np.argsort(kept["parcel_labels"][:, 0])]


def run(geldart, *arguments, case=MIXTURE, **keywords):
    done = geldart(case, *arguments, **keywords)
    assert done.returncode == 0, f"exit {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}"
    return done


@pytest.mark.parametrize("effects", [[], EFFECTS], ids=["plain", "effects"])
def test_ranks(geldart, tmp_path, effects):
    for ranks in (1, 2, 4):
        run(geldart, "--out", f"on{ranks}", "--set", "run%end_time=0.01", *effects, ranks=ranks)
    one = sorted_parcels(tmp_path / "on1/restart.h5")
    for ranks in (2, 4):
        other = sorted_parcels(tmp_path / f"on{ranks}/restart.h5")
        assert np.abs(other[:, :3] - one[:, :3]).max() < 1e-10 * 0.03, ranks


@pytest.mark.parametrize("ranks, mode", [(1, "release"), (2, "release"), (2, "debug")])
def test_restart_is_exact(geldart, tmp_path, ranks, mode):
    end = 0.05 if mode == "release" else 0.02
    run(geldart, "--out", "whole", "--set", f"run%end_time={end}", ranks=ranks, mode=mode)
    run(geldart, "--out", "parts", "--set", f"run%end_time={end / 2}", ranks=ranks, mode=mode)
    run(geldart, "--out", "parts", "--set", f"run%end_time={end}", "--restart", "parts/restart.h5", ranks=ranks, mode=mode)
    whole, parts = state(tmp_path / "whole/restart.h5"), state(tmp_path / "parts/restart.h5")
    assert whole["least"].size == 2 * 4
    for name in whole:
        assert np.array_equal(whole[name], parts[name]), f"{name} differs"


def test_restart_with_effects(geldart, tmp_path):
    """Angles rolled are dealt to the pairs of materials, and gathered from them, as slips are; each pair attracts as before."""
    run(geldart, "--out", "whole", "--set", "run%end_time=0.03", *EFFECTS, ranks=2)
    run(geldart, "--out", "parts", "--set", "run%end_time=0.015", *EFFECTS, ranks=2)
    run(geldart, "--out", "parts", "--set", "run%end_time=0.03", "--restart", "parts/restart.h5", *EFFECTS, ranks=2)
    whole, parts = state(tmp_path / "whole/restart.h5"), state(tmp_path / "parts/restart.h5")
    assert np.abs(whole["contact_slip"][:, 3:]).max() > 1e-3
    for name in whole:
        assert np.array_equal(whole[name], parts[name]), f"{name} differs"


def test_names_make_no_difference(geldart, tmp_path):
    """Other names in the same order: the same run to the last bit."""
    renamed = MIXTURE.read_text().replace("'glass'", "'x'").replace("'steel'", "'glass'").replace("'x'", "'steel'")
    (tmp_path / "renamed.nml").write_text(renamed)
    run(geldart, "--out", "one", "--set", "run%end_time=0.02")
    run(geldart, "--out", "other", "--set", "run%end_time=0.02", case="renamed.nml")
    one, other = state(tmp_path / "one/restart.h5"), state(tmp_path / "other/restart.h5")
    for name in one:
        assert np.array_equal(one[name], other[name]), f"{name} differs"


def test_equal_materials_are_one(geldart, tmp_path):
    """Materials that say what &contact says make the run without materials, to the last bit."""
    lines = [line for line in MIXTURE.read_text().splitlines() if not line.startswith(("&material", "&contact"))]
    common = ("stiffness = 300, restitution = 0.7, friction = 0.4, rolling_friction = 0.1, rolling_damping = 0.7, "
              "hamaker_constant = 2e-15")
    choice = "rolling = 'spring', cohesion = 'van_der_waals', minimum_separation = 1e-7, maximum_separation = 1e-5 /"
    several = [f"&material id = '{name}', {common} /" for name in ("glass", "steel", "rubber")]
    (tmp_path / "several.nml").write_text("\n".join([*lines, *several, f"&contact wall_material = 'glass', {choice}"]))
    plain = "\n".join([*lines, f"&contact {common}, {choice}"])
    for name in ("glass", "steel", "rubber"):
        plain = plain.replace(f", material = '{name}'", "")
    (tmp_path / "plain.nml").write_text(plain)
    for case in ("several", "plain"):
        run(geldart, "--out", case, "--set", "run%end_time=0.02", case=f"{case}.nml", ranks=2)
    one, other = state(tmp_path / "plain/restart.h5"), state(tmp_path / "several/restart.h5")
    assert len(one["contact_partner"]) > 30
    for name in one:
        assert np.array_equal(one[name], other[name]), f"{name} differs"


def test_description(geldart):
    """Every pair that may meet has its line, the given pair with what is given; none of rubber parcels, there are none."""
    text = run(geldart, "--check").stdout
    for line in (
        "3 different between parcels, 5 with walls",
        "glass - glass: spring 200 N/m, restitution 0.9, friction 0.2",
        "glass - steel: spring 285.7 N/m, restitution 0.8, friction 0.35",
        "steel - wall of rubber: spring 166.7 N/m, restitution 0.4899, friction 0.6708",
        "floor: of steel",
        "the rest of the surface: wall of glass",
        "plate: plane of rubber",
    ):
        assert line in text, f"{line}\n{text}"
    assert "rubber -" not in text


def test_description_of_effects(geldart):
    """Rolling friction and attraction of every pair stand in its line, none where there is none; of one material, once."""
    text = run(geldart, "--check", *EFFECTS).stdout
    for line in (
        "glass - glass: spring 200 N/m, restitution 0.9, friction 0.2, rolling friction 0.05, attraction 1e-15 J",
        "glass - steel: spring 285.7 N/m, restitution 0.8, friction 0.35, rolling friction 0.3, attraction 3e-15 J",
        "steel - wall of steel: spring 500 N/m, restitution 0.6, friction 0.5, rolling friction 0.2, attraction 4e-15 J",
        "steel - wall of rubber: spring 166.7 N/m, restitution 0.4899, friction 0.6708, rolling friction 0, attraction 0 J",
        "van der Waals attraction, up to a gap of 1e-5 m, constant below 1e-7 m",
        "rolling friction by a spring: contacts remember the angle they have rolled",
    ):
        assert line in text, f"{line}\n{text}"
    one = ("contact%rolling=constant_torque", "contact%rolling_friction=0.1", "contact%wall_rolling_friction=0.2",
           "contact%friction=0.3", "contact%cohesion=van_der_waals", "contact%hamaker_constant=1e-15",
           "contact%wall_hamaker_constant=2e-15", *SEPARATIONS)
    text = run(geldart, "--check", *(word for setting in one for word in ("--set", setting)), case=ROOT / "tests/runs/drum.nml").stdout
    assert "van der Waals attraction, 1e-15 J, 2e-15 J at walls, up to a gap of 1e-5 m, constant below 1e-7 m" in text, text
    assert "rolling friction 0.1, 0.2 on walls by a constant torque, which holds nothing at rest" in text, text


def test_pair_by_option(geldart):
    text = run(geldart, "--check", "--set", "material_pair(1)%materials=steel steel").stdout
    assert "glass - steel: spring 285.7 N/m, restitution 0.7348, friction 0.3162" in text
    assert "steel - steel: spring 500 N/m, restitution 0.8, friction 0.35" in text

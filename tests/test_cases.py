"""Each case of cases/, and each variant of it that its script names, starts as it stands and runs for some steps.

The runs themselves, and what comes of them, are for `make validate`.
"""

import importlib.util

import h5py
import pytest

from conftest import ROOT, launch, program

STEPS, END = 5, 0.005  # s; of 1 ms, in which parcels make many


def scripts():
    """The Python file beside each case.nml, as a module: {name of the case: module}."""
    found = {}
    for case in sorted((ROOT / "cases").glob("*/case.nml")):
        (path,) = case.parent.glob("*.py")
        spec = importlib.util.spec_from_file_location(f"{path.stem}_{case.parent.name}", path)
        found[case.parent.name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(found[case.parent.name])
    return found


def variants():
    for case, script in scripts().items():
        for name, options in script.VARIANTS.items():
            yield pytest.param(case, options, id=f"{case}-{name}")


@pytest.mark.parametrize("case, options", list(variants()))
def test_starts(tmp_path, case, options):
    """It is accepted, comes to its end with all its parcels, and leaves its results."""
    sets = [word for option in [*options, f"run%end_time={END}"] for word in ("--set", option)]
    done = launch(program("src/geldart"), ROOT / "cases" / case / "case.nml", "--out", "out", *sets, cwd=tmp_path)
    assert done.returncode == 0, f"exit {done.returncode}\n{done.stdout[-1000:]}\n{done.stderr[-3000:]}"
    with h5py.File(tmp_path / "out/monitor.h5") as file:
        parcels = file["series/parcels"][0]
    with h5py.File(tmp_path / "out/restart.h5") as file:
        time, steps = file["clock"][:2]
        assert (time, steps) == (pytest.approx(END), STEPS)
        assert len(file["parcels"]) == parcels > 0
    assert (tmp_path / "out/parcels.vtkhdf").exists()

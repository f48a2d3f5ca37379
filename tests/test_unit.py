"""Every program tests/unit/test_*.f90, in both builds, on 1 rank, or on 1, 2 and 4 where it starts ranks.

In the debug build only programs about what ranks give each other run on 4: on two cores these are the slowest. The gas and
the lists of neighbours do so in release alone; what they exchange with is in `halo`, `route` and `des_many`.

A program prints 'ok NAME' or 'FAIL NAME' for each thing it expects, and 'finished' when it has come
to its end. A comment '! ranks: 1 3' among its first lines asks for other numbers of ranks, '! ranks in debug: 1' for those
of that build.
"""

import re

import pytest

from conftest import MODES, ROOT, launch, program


EXCHANGES = {"boxes", "communicator", "coupling_mapping", "des_many", "halo", "restart", "route", "spreading", "tiles", "transfer"}


def ranks_of(source, mode):
    """On how many ranks a test program runs."""
    text = source.read_text()
    first = "\n".join(text.splitlines()[:20])
    asked = re.search(r"^!>? *ranks: *([0-9 ]+)$", first, re.MULTILINE)
    if mode == "debug":
        asked = re.search(r"^!>? *ranks in debug: *([0-9 ]+)$", first, re.MULTILINE) or asked
    if asked:
        return [int(n) for n in asked.group(1).split()]
    if "start_ranks" not in text:
        return [1]
    return [1, 2] if mode == "debug" and source.stem[5:] not in EXCHANGES else [1, 2, 4]


def cases():
    for source in sorted((ROOT / "tests/unit").glob("test_*.f90")):
        for mode in MODES:
            for ranks in ranks_of(source, mode):
                yield pytest.param(source.stem, mode, ranks, id=f"{source.stem[5:]}-{mode}-{ranks}")


@pytest.mark.parametrize("name, mode, ranks", list(cases()))
def test_unit(name, mode, ranks, tmp_path):
    path = program(f"tests/unit/{name}", mode)
    assert path.exists(), f"{path} is not built: make MODE={mode} unit"
    (tmp_path / "build/tests").mkdir(parents=True)  # where programs write, in a folder of each run: runs may be at the same time
    done = launch(path, ranks=ranks, cwd=tmp_path, time_limit=300)
    lines = done.stdout.splitlines()
    failed = [line for line in lines if line.startswith("FAIL")]
    shown = "\n".join([*failed, done.stderr[-3000:]])
    assert not failed, shown
    assert done.returncode == 0, f"exit {done.returncode}\n{shown}\n{done.stdout[-1000:]}"
    assert "finished" in lines, f"it never came to its end\n{shown}\n{done.stdout[-1000:]}"
    assert any(line.startswith("ok") for line in lines), "it expects nothing"

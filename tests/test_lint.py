"""The checks of `make lint` that are our own see what they are there to see."""

import subprocess

import pytest

from conftest import ROOT


def awk(script, files, folder, *options):
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    command = ["awk", *options, "-f", str(ROOT / "src/build" / script), *files]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True)


def module(name, *used):
    return f"module {name}\n" + "".join(f"  use {m}, only: x\n" for m in used) + "end module\n"


ORDER = ["-v", "ORDER=src/base model/gas,model/des model/run"]


def test_layers_allow_what_lies_below(tmp_path):
    files = {"src/base/a.f90": module("a"), "model/gas/b.f90": module("b", "a"), "model/run/c.f90": module("c", "a", "b")}
    done = awk("layers.awk", files, tmp_path, *ORDER)
    assert (done.returncode, done.stdout) == (0, "")


@pytest.mark.parametrize(
    "place, used, message",
    [
        ("src/base", "b", "src/base may not use b of model/gas"),
        ("model/des", "b", "model/des may not use b of model/gas"),
        ("model/new", "b", "no layer of that name"),
    ],
)
def test_layers_refuse_the_rest(tmp_path, place, used, message):
    done = awk("layers.awk", {"model/gas/b.f90": module("b"), f"{place}/d.f90": module("d", used)}, tmp_path, *ORDER)
    assert done.returncode == 1
    assert message in done.stdout


def test_layers_refuse_two_modules_of_one_name(tmp_path):
    done = awk("layers.awk", {"model/gas/b.f90": module("b"), "model/des/b.f90": module("b")}, tmp_path, *ORDER)
    assert done.returncode == 1


@pytest.mark.parametrize(
    "text, message",
    [
        ("integer :: i \n", "1: blanks at the end"),
        ("!\tx\n", "1: a tab"),
        ("!\r\n", "1: a carriage return"),
        ("\n! " + "x" * 131 + "\n", "2: a line of 133 characters"),
        ("! TO" + "DO\n", "1: unfinished"),
        ("use hdf5\n", "1: uses hdf5"),
        ("use, non_intrinsic :: mpi_f08, only: x\n", "1: uses mpi_f08"),
        ("pure subroutine long(x)\n" + "x\n" * 91 + "end subroutine long\n", "93: a procedure of 92 lines"),
        ("x\n" * 451, "451: a file of 451 lines"),
    ],
)
def test_style_sees(tmp_path, text, message):
    done = awk("style.awk", {"a.f90": text}, tmp_path)
    assert done.returncode == 1
    assert f"a.f90:{message}" in done.stdout


def test_style_lets_good_code_pass(tmp_path):
    done = awk("style.awk", {"a.f90": module("a"), "b.md": "text, as long as it wants" * 9 + "\n"}, tmp_path)
    assert (done.returncode, done.stdout) == (0, "")

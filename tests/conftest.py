"""What all tests share: where the programs are and how to run them on some ranks."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
MODES = ("release", "debug")
TIME_LIMIT = 600  # s, of any one program

# Where the folders release and debug of the built programs are; another place lets two builds be tested side by side.
BUILD = ROOT / os.environ.get("GELDART_BUILD", "build")

# Several programs share the cores: none may be bound to one.
os.environ.setdefault("OMPI_MCA_hwloc_base_binding_policy", "none")


def launch(program, *arguments, ranks=1, cwd=ROOT, time_limit=TIME_LIMIT):
    """Run a program and return the completed process, with what it printed in .stdout and .stderr."""
    command = ["sh", str(ROOT / "src/build/launch.sh"), str(ranks), str(program), *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, errors="replace", timeout=time_limit)


def program(name, mode="release"):
    """Path of a built program, such as 'src/geldart'."""
    return BUILD / mode / name


@pytest.fixture(params=MODES)
def mode(request):
    """The optimized build, then the one that checks everything at run time."""
    return request.param


@pytest.fixture
def geldart(tmp_path):
    """geldart(case, *options, ranks=1, mode='release') runs the program in an empty folder."""

    def run(*arguments, ranks=1, mode="release", time_limit=TIME_LIMIT):
        return launch(program("src/geldart", mode), *arguments, ranks=ranks, cwd=tmp_path, time_limit=time_limit)

    return run

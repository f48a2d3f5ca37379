"""The loops of the contact laws and of the gas are vector loops: a condition too many splits one, and nothing but its speed would tell."""

import subprocess

import pytest

from conftest import ROOT


@pytest.mark.parametrize(
    ("name", "head", "loops"),
    [
        ("model/des/contact_linear", "do k = 1, lanes", 6),
        ("model/des/contact_hertz", "do k = 1, lanes", 2),
        ("model/gas/convection", "do i = 1, n", 3),
        ("model/gas/momentum_cells", "do i = 1, m", 3),
        ("model/gas/momentum", "do i = lo(1), n(1)", 2),
        ("src/linear/pressure_solver", "do i = 1, n(1)", 4),
        ("src/linear/momentum_solver", "do i = lo(1), n(1)", 3),
    ],
)
def test_vector_loops(tmp_path, name, head, loops):
    compiler = (ROOT / "build/release/flags").read_text().splitlines()[0].split()
    if "GNU" not in subprocess.run([compiler[0], "--version"], capture_output=True, text=True).stdout:
        pytest.skip("asks gfortran for its report")
    source = ROOT / f"{name}.f90"
    lines = [line.split("!")[0].strip() for line in source.read_text().splitlines()]
    kernels = [n for n, line in enumerate(lines, 1) if line == head]
    assert len(kernels) == loops
    report = subprocess.run([*compiler, "-fopt-info-vec-optimized", f"-I{ROOT}/build/release", f"-J{tmp_path}", "-c", str(source),
                             "-o", str(tmp_path / "loops.o")], capture_output=True, text=True, check=True).stderr
    vectorized = {int(line.split(":")[1]) for line in report.splitlines() if "loop vectorized" in line}
    ends = [lines.index("end do", start) + 1 for start in kernels]
    assert all(any(start <= line <= end for line in vectorized) for start, end in zip(kernels, ends, strict=True))

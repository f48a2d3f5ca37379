"""The settled bed of bench_contacts in LAMMPS and LIGGGHTS, timed in turn with geldart.

usage: peers.py build/release build/bench_peers.json [RUNS]

50 000 spheres of 1 mm, k_n = 200 N/m, k_t = 2/7 k_n, e = 0.9, mu = 0.1, five plane walls, a step of t_c/50, shaken at 50 Hz; one
core each, the medians of RUNS (five) runs. All make new neighbour lists every 200 steps, which counts; those of the peers reach
0.1 mm beyond contact, ours 0.25 mm. Only the parameters are the same, trajectories are not compared. Where they are not installed: apt-get install lammps liggghts.
"""

import json
import math
import re
import shutil
import statistics
import struct
import subprocess
import sys
from pathlib import Path

from run import ROOT, processor

N, DIAMETER, DENSITY, BASE = 50_000, 1e-3, 2500.0, 0.05
STIFFNESS, RESTITUTION, FRICTION = 200.0, 0.9, 0.1
STEPS = 1000

EFFECTIVE_MASS = DENSITY * math.pi / 6 * DIAMETER**3 / 2
ZETA = -math.log(RESTITUTION) / math.hypot(math.pi, math.log(RESTITUTION))
OMEGA = math.sqrt(STIFFNESS / EFFECTIVE_MASS)
STEP = math.pi / (OMEGA * math.sqrt(1 - ZETA**2)) / 50
GAMMA = 2 * ZETA * OMEGA  # per effective mass, as both peers take it [1/s]

COMMON = f"""units si
atom_style {{style}}
boundary f f f
newton off
{{velocities}}
read_data bed.data
neighbor 1e-4 bin
neigh_modify delay 0 every 200 check no
{{law}}
fix move all nve/sphere
variable pull equal 9.81*(1+0.5*sin(2*PI*50*step*{STEP}))
fix gravity all gravity v_pull vector 0 0 -1
timestep {STEP}
thermo {STEPS}
run {STEPS}
"""
HOOKE = f"hooke/history {STIFFNESS} {STIFFNESS * 2 / 7} {GAMMA} NULL {FRICTION} 1"
LAMMPS = COMMON.format(style="sphere", velocities="comm_modify vel yes", law="\n".join(
    [f"pair_style gran/{HOOKE}", "pair_coeff * *"]
    + [f"fix wall{a} all wall/gran {HOOKE} {a}plane 0 {BASE if a != 'z' else 'NULL'}" for a in "xyz"]))
LIGGGHTS = COMMON.format(style="granular", velocities="communicate single vel yes", law="\n".join(
    [f"fix m{i} all property/global {words}" for i, words in enumerate([
        "youngsModulus peratomtype 5e6", "poissonsRatio peratomtype 0.45", f"kn peratomtypepair 1 {STIFFNESS}",
        f"kt peratomtypepair 1 {STIFFNESS * 2 / 7}", f"gamman peratomtypepair 1 {GAMMA}",
        f"gammat peratomtypepair 1 {GAMMA / 2}", f"coefficientFriction peratomtypepair 1 {FRICTION}",
        f"coefficientRestitution peratomtypepair 1 {RESTITUTION}"])]
    + ["pair_style gran model hooke/stiffness tangential history", "pair_coeff * *"]
    + [f"fix wall{a}{i} all wall/gran model hooke/stiffness tangential history primitive type 1 {a}plane {x}"
       for a, i, x in [("x", 0, 0), ("x", 1, BASE), ("y", 0, 0), ("y", 1, BASE), ("z", 0, 0)]]))


def write_data(bed, data):
    """The places that bench_contacts keeps, reals of eight bytes, as a data file of the peers."""
    x = struct.unpack(f"{3 * N}d", bed.read_bytes())
    with data.open("w") as file:
        file.write(f"settled bed\n\n{N} atoms\n1 atom types\n\n0 {BASE} xlo xhi\n0 {BASE} ylo yhi\n0 0.08 zlo zhi\n\nAtoms\n\n")
        for i in range(N):
            file.write(f"{i + 1} 1 {DIAMETER} {DENSITY} {x[3 * i]!r} {x[3 * i + 1]!r} {x[3 * i + 2]!r}\n")


def rate_of_peer(program, script, folder):
    """Particle-steps per second that a peer reaches."""
    done = subprocess.run([program, "-in", script], cwd=folder, capture_output=True, text=True)
    told = re.search(r"Loop time of ([0-9.eE+-]+)", done.stdout)
    if not told:
        sys.exit(f"{program} failed:\n{done.stdout[-1000:]}{done.stderr[-1000:]}")
    return N * STEPS / float(told.group(1))


def rate_of_ours(program, bed):
    done = subprocess.run([program, str(STEPS), str(FRICTION), bed], capture_output=True, text=True, check=True)
    return float(re.search(r"bench contacts_rate +(\S+)", done.stdout).group(1))


def main(build, result, runs=5):
    folder = (ROOT / build).parent / "peers"
    folder.mkdir(exist_ok=True)
    program, bed = ROOT / build / "tests/bench/bench_contacts", folder / "bed.bin"
    rate_of_ours(program, bed)  # makes the bed where there is none
    write_data(bed, folder / "bed.data")
    (folder / "in.lammps").write_text(LAMMPS)
    (folder / "in.liggghts").write_text(LIGGGHTS)
    peers = {name: shutil.which(command) for name, command in (("LAMMPS", "lmp"), ("LIGGGHTS", "liggghts"))}
    missing = [name for name in peers if not peers[name]]
    if missing:
        sys.exit(f"{' and '.join(missing)} not found: apt-get install lammps liggghts")
    rates = {"geldart": []} | {name: [] for name in peers}
    for _ in range(int(runs)):
        rates["geldart"].append(rate_of_ours(program, bed))
        for name, command in peers.items():
            rates[name].append(rate_of_peer(command, f"in.{name.lower()}", folder))
    median = {name: statistics.median(values) for name, values in rates.items()}
    print(f"{processor()}, one core, settled bed of {N} spheres, medians of {runs}")
    for name, rate in median.items():
        spread = f"{min(rates[name]) / 1e6:.2f} to {max(rates[name]) / 1e6:.2f}"
        print(f"  {name:10} {rate / 1e6:6.2f} M particle-steps/s ({spread})   geldart is {median['geldart'] / rate:.2f} times as fast")
    Path(result).write_text(json.dumps({f"peers_{name}": {"value": rate, "unit": "particle-steps/s", "runs": rates[name]}
                                        for name, rate in median.items()}, indent=1) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])

"""What the cases of fluidized beds share: a bed whose gas is changed step by step, and what the drag law makes of it.

Powders are pairs of arrays, diameter [m] and weight, how many real particles have it.
"""

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
DENSITY, VISCOSITY, GRAVITY = 1.2, 1.8e-5, 9.81  # of the gas of all these cases, SI


def step_through(here, program, folder, stages, measure, options=()):
    """Run case.nml of a folder at each (velocity, duration) in turn, each continuing the one before from its restart file.

    measure(results folder, velocity) gives what is returned of each. Without a program what was run before is measured again.
    """
    found, before, end = [], [], 0.0
    if program:
        shutil.rmtree(folder, ignore_errors=True)
    for number, (velocity, duration) in enumerate(stages):
        end += duration
        out = Path(folder) / f"{number:02}_{velocity:g}"
        sets = [f"boundary(distributor)%velocity={velocity}", f"run%end_time={end:.4f}", *options]
        command = ["sh", str(ROOT / "src/build/launch.sh"), "1", str(program), str(here / "case.nml"), "--out", str(out),
                   *before, *(word for option in sets for word in ("--set", option))]
        done = subprocess.run(command, capture_output=True, text=True) if program else None
        if done and done.returncode:
            sys.exit(f"{' '.join(command)}\nended with {done.returncode}\n{done.stderr}")
        found.append(measure(out, velocity))
        before = ["--restart", str(out / "restart.h5")]
    return found


def gidaspow(reynolds, eps):
    """Drag over Stokes drag of the superficial velocity, void fractions of 0.8 and below: Ergun."""
    return (150 * (1 - eps) + 1.75 * reynolds) / (18 * eps**2)


def beetstra(reynolds, eps):
    """The same by Beetstra, van der Hoef, Kuipers, AIChE J. 53 (2007) 489-501, of one size."""
    phi = 1 - eps
    inertia = (1 / eps + 3 * eps * phi + 8.4 * reynolds**-0.343) / (1 + 10 ** (3 * phi) * reynolds ** (-(1 + 4 * phi) / 2))
    return 10 * phi / eps**2 + eps**2 * (1 + 1.5 * np.sqrt(phi)) + 0.413 * reynolds / (24 * eps**2) * inertia


def carried(velocity, eps, powder, solid, law=gidaspow):
    """Drag of real particles over the share of their weight, less buoyancy, that drag carries in a fluidized bed.

    The pressure gradient is the weight of all particles per volume of bed; on a particle it carries 1 - eps of its weight.
    """
    diameter, weight = powder
    reynolds = DENSITY * velocity * diameter / VISCOSITY
    drag = 3 * np.pi * VISCOSITY * diameter * law(reynolds, eps) * velocity
    volume = np.pi / 6 * diameter**3
    return np.sum(weight * drag) / np.sum(weight * volume * (solid - DENSITY) * GRAVITY * eps)


def carrying_velocity(eps, powder, solid, law=gidaspow):
    """Superficial velocity at which the drag law carries the powder at a void fraction [m/s]."""
    low, high = 1e-5, 5.0
    for _ in range(60):
        middle = (low + high) / 2
        if carried(middle, eps, powder, solid, law) < 1:
            low = middle
        else:
            high = middle
    return low


def crossing(velocity, ratio):
    """Velocity at which the pressure drop of a packed bed, a U + b U^2 over its weight, reaches 1; a and b [s/m, s2/m2]."""
    (a, b), *_ = np.linalg.lstsq(np.stack([velocity, velocity**2], axis=1), ratio, rcond=None)
    return 2 / (a + np.sqrt(a**2 + 4 * b)), a, b  # the positive root, also for b = 0

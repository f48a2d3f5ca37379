"""What rolling resistance and attraction cost a run that has neither: geldart against a copy that cannot do them.

usage: off.py build/release build/bench_off.json

From a copy of the program under build/off the procedures of both effects are deleted, with every branch that leads to them; a
use that is left does not compile. Both move W1, with friction, to the same bits for 100 steps. Then they run at the same time on
one core, which takes them in turn every few milliseconds, so that a noisy machine is as noisy for both; what counts is the
processor time of each.
"""

import json
import os
import re
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

from run import BEDS, ROOT, processor

COPY = ROOT / "build/off"
DES = COPY / "model/des"
RUNS, STEPS = 11, 400
OFF = re.compile(r"[\w%]*(rolling%on|rolling%spring|with_angles)")  # conditions that are false
MODULES = ("wall_rolling", "cohesion_sweep")                        # deleted as a whole
KERNELS = {"rolling": "rolling_torques constant_torques spring_torques", "cohesion": "attractions across_gaps by_area"}


def statements(lines):
    """(first line, line after the last, text) of each statement; comments are none."""
    n = 0
    while n < len(lines):
        first, text = n, code_of(lines[n])
        while text.endswith("&"):
            n += 1
            text = text[:-1] + code_of(lines[n])
        n += 1
        if text:
            yield first, n, text


def code_of(line):
    return re.match(r"""([^!'"]|'[^']*'|"[^"]*")*""", line).group().strip()


def taken_apart(text):
    """Condition and rest of an if statement, or nothing and the statement."""
    if not text.startswith("if ("):
        return "", text
    depth = 0
    for n, letter in enumerate(text):
        depth += (letter == "(") - (letter == ")")
        if letter == ")" and depth == 0:
            return text[4:n], text[n + 1:].strip()
    return "", text


def is_off(condition):
    return ".or." not in condition and any(OFF.fullmatch(term.strip()) for term in condition.split(".and."))


def without_branches(lines, gone):
    """The lines without the statements that are reached only if an effect is on, or that call what is gone."""
    lines, kept = list(lines), [True] * len(lines)
    blocks = []  # of each if block its first line where its condition is off, "bare" where the if before an else is gone, else None
    for first, end, text in statements(lines):
        condition, rest = taken_apart(text)
        if condition and rest == "then":
            blocks.append(first if is_off(condition) else None)
        elif text == "end if" or text.startswith("else"):
            begin = blocks.pop()
            if text == "end if" and begin == "bare":
                kept[first:end] = [False] * (end - first)
            elif text == "end if" and begin is not None:
                kept[begin:end] = [False] * (end - begin)
            elif text == "else" and begin is not None:
                kept[begin:end] = [False] * (end - begin)
                blocks.append("bare")
            elif text.startswith("else if") and begin is not None:
                kept[begin:first] = [False] * (first - begin)
                lines[first] = lines[first].replace("else if", "if", 1)
                blocks.append(None)
            elif text != "end if":
                blocks.append(begin)
        else:
            called = re.match(r"call (\w+)", rest)
            if (condition and is_off(condition)) or (called and called.group(1) in gone):
                kept[first:end] = [False] * (end - first)
    return [line for line, stays in zip(lines, kept, strict=True) if stays]


def without_procedure(lines, name):
    """The lines without a procedure and the docstring before it."""
    begin, end = (re.compile(rf" *{words}(subroutine|function) {name}\b") for words in ("((pure|recursive|elemental) )*", "end "))
    first = next(n for n, line in enumerate(lines) if begin.match(line))
    last = next(n for n, line in enumerate(lines) if end.match(line))
    while lines[first - 1].strip().startswith("!"):
        first -= 1
    return lines[:first] + lines[last + 2:]


def without_idle(lines):
    """The lines without procedures that nothing names any more."""
    while True:
        text = "\n".join(lines)
        for name in re.findall(r"^ *end (?:subroutine|function) (\w+)", text, re.MULTILINE):
            rest = "\n".join(without_procedure(lines, name))
            if not re.search(rf"\b{name}\b", re.sub(r"!.*", "", rest)):
                lines = rest.split("\n")
                break
        else:
            return lines


def without_names(lines, gone):
    """The lines without what is gone in the lists of `use` and `public`."""
    lines = list(lines)
    for first, end, text in statements(lines):
        listed = re.match(r"(use \w+, only: |public :: )(.*)", text)
        if listed and gone & set(listed.group(2).split(", ")):
            left = ", ".join(name for name in listed.group(2).split(", ") if name not in gone)
            lines[first:end] = [f"  {listed.group(1)}{left}" if left else "  ! gone"] + ["  ! gone"] * (end - first - 1)
    return lines


def delete():
    """Make the copy; the numbers of statements of model/des before and after."""
    for folder in ("src", "model", "tests/bench"):
        shutil.rmtree(COPY / folder, ignore_errors=True)
        shutil.copytree(ROOT / folder, COPY / folder)
    for file in ("Makefile", "config.mk"):
        if (ROOT / file).exists():
            shutil.copy2(ROOT / file, COPY / file)
    gone = {name for names in KERNELS.values() for name in names.split()}
    for module in MODULES:
        gone |= set(re.findall(r"^ *end (?:subroutine|function) (\w+)", (DES / f"{module}.f90").read_text(), re.MULTILINE))
    before = after = 0
    for path in sorted(DES.glob("*.f90")):
        lines = path.read_text().splitlines()
        before += len(list(statements(lines)))
        if path.stem in MODULES:
            path.unlink()
            continue
        for name in KERNELS.get(path.stem, "").split():
            lines = without_procedure(lines, name)
        lines = without_idle(without_names(without_branches(lines, gone), gone))
        after += len(list(statements(lines)))
        path.write_text("\n".join(lines) + "\n")
    return before, after


def times(programs, core):
    """Processor time of each that W1 takes, all at once on one core [s]."""
    runs = [subprocess.Popen([program, str(BEDS), "W1", str(STEPS)], stdout=subprocess.DEVNULL,
                             preexec_fn=lambda: os.sched_setaffinity(0, {core})) for program in programs]
    ends = [os.wait4(run.pid, 0) for run in runs]
    if any(status for _, status, _ in ends):
        sys.exit("a program failed")
    return {program: usage.ru_utime for program, (_, _, usage) in zip(programs, ends, strict=True)}


def places(program):
    """Where the parcels of W1 are after 100 steps, as bytes."""
    subprocess.run([program, str(BEDS), "W1", "0"], check=True)
    return (BEDS / "W1.after").read_bytes()


def main(build, result, make="make"):
    program, other = (folder / build / "tests/bench/bench_contacts" for folder in (ROOT, COPY))
    BEDS.mkdir(exist_ok=True)
    before, after = delete()
    print(f"deleted {before - after} of {before} statements of model/des")
    done = subprocess.run([make, "--no-print-directory", "-s", "-C", str(COPY), f"{build}/tests/bench/bench_contacts"],
                          capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"something still uses what was deleted:\n{done.stderr}")
    if not (BEDS / "W1.bed").exists():
        subprocess.run([program, str(BEDS), "W1", "200"], stdout=subprocess.DEVNULL, check=True)
    if places(program) != places(other):
        sys.exit("without rolling resistance and attraction W1 moves otherwise")
    cores, ratios = sorted(os.sched_getaffinity(0)), []
    for run in range(RUNS):
        took = times((program, other) if run % 2 else (other, program), cores[run // 2 % len(cores)])
        ratios.append(took[program] / took[other])
        print(f"  {ratios[-1]:.3f}", flush=True)
    cost = statistics.median(ratios)
    print(f"{processor()}: W1 takes {cost:.3f} times as long with the code of rolling resistance and attraction as without it, "
          f"median of {RUNS} runs")
    Path(result).write_text(json.dumps({"off_W1": {"value": cost, "unit": "of_without", "runs": ratios}}, indent=1) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])

#!/usr/bin/env python3
"""Solves every SDPA file of a folder with `steadfast solve` and with csdp and prints a Markdown table.

    python3 docs/tools/sdplib.py STEADFAST FOLDER [SECONDS]

STEADFAST is the program; FOLDER holds .dat-s files such as those of SDPLIB 1.2 (B. Borchers, Optimization Methods and
Software 11:683-690, 1999); SECONDS limits each run (default 300). The published optimum of the problems known here
stands in the second column; for others that column is empty and csdp's value is what the digits are counted against.
CPU seconds are those of the whole process, user and system, all threads. csdp's columns are empty where it is not
installed.
"""

import json
import math
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

PUBLISHED = {
    "control1": "17.78463", "control2": "8.300000", "control3": "13.63327", "control4": "19.79423",
    "truss1": "-8.999996", "truss2": "-123.3804", "truss3": "-9.109996", "truss4": "-9.009996",
    "hinf1": "2.0326", "hinf2": "10.967", "hinf3": "56.9", "hinf4": "274.764", "hinf5": "363",
    "hinf6": "449.0", "hinf7": "391", "hinf8": "116",
    "theta1": "23.00000", "qap5": "-436.0000", "gpp100": "-44.94355",
    "infd1": "unbounded", "infp1": "infeasible",
}


def timed(command, seconds, folder):
    """Output and CPU seconds of a command; no output when it takes too long."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        run = subprocess.run(command, capture_output=True, text=True, timeout=seconds, cwd=folder, check=False)
        output = run.stdout
    except subprocess.TimeoutExpired:
        output = ""
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return output, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def csdp(file, seconds, folder):
    """csdp's objective (as text, None without one) and CPU seconds."""
    if shutil.which("csdp") is None:
        return None, None
    output, cpu = timed(["csdp", str(file)], seconds, folder)
    for line in output.splitlines():
        if line.startswith("Primal objective value:"):
            return line.split(":")[1].strip(), cpu
        if "infeasible" in line and line.startswith("Success"):
            # csdp's primal is the dual here.
            return "unbounded" if "primal infeasible" in line else "infeasible", cpu
    return None, cpu


def digits(value, reference):
    """Decimal digits that agree, at most those that the reference has."""
    try:
        target = float(reference)
    except (TypeError, ValueError):
        return ""
    if value is None:
        return "none"
    figures = reference.lower().split("e")[0].lstrip("-")
    given = len(figures.replace(".", "").lstrip("0"))
    # The last published digit may be rounded either way.
    unit = 10.0 ** -len(figures.partition(".")[2]) if "e" not in reference.lower() else 0.0
    difference = abs(value - target)
    if difference <= unit:
        return f"{given} of {given}"
    agreed = -math.log10(difference / abs(target)) if target else -math.log10(difference)
    return f"{max(0.0, min(agreed, float(given))):.1f} of {given}"


def short(number):
    return "" if number is None else f"{number:.0e}" if number else "0"


def row(program, file, seconds, folder):
    name = file.name.split(".")[0]
    output, cpu = timed([program, "solve", str(file), "--json"], seconds, folder)
    report = json.loads(output) if output else {"status": "no answer"}
    other, other_cpu = csdp(file, seconds, folder)
    published = PUBLISHED.get(name, "")
    objective = report.get("objective")
    residual = report.get("certificate_residual")
    measures = [report.get(key) for key in ("uncertainty", "relative_gap", "violation", "dual_residual")]
    return [
        name,
        published,
        report["status"] + ("" if residual is None else f", residual {short(residual)}"),
        "" if objective is None else f"{objective:.8g}",
        digits(objective, published or other),
        *map(short, measures),
        f"{cpu:.2f}",
        other or "",
        "" if other_cpu is None else f"{other_cpu:.2f}",
    ]


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    program = str(Path(sys.argv[1]).resolve())
    seconds = float(sys.argv[3]) if len(sys.argv) == 4 else 300.0
    title = ["problem", "published", "status", "objective", "digits", "uncertainty", "gap", "violation",
             "dual residual", "CPU s", "csdp", "csdp CPU s"]
    print("| " + " | ".join(title) + " |")
    print("|" + "---|" * len(title))
    with tempfile.TemporaryDirectory() as folder:
        for file in sorted(Path(sys.argv[2]).resolve().glob("*.dat-s")):
            print("| " + " | ".join(row(program, file, seconds, folder)) + " |", flush=True)


if __name__ == "__main__":
    main()

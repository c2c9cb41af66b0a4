#!/usr/bin/env python3
"""Two tables of docs/results/reproduction.md that `make table` does not print. scripts/reproduction.sh calls it.

  reproduction-tables.py nees PROGRAM NCLT_DIRECTORY SESSION...   NEES of the odometry, by length of window
  reproduction-tables.py difference TABLE.csv OTHER.csv           RMSE of the second less that of the first, run by run
"""

import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

# The covariance that axes of maps refer to: metres and radians a keyframe step.
SIGMAS = ("0.1", "0.016666666666666666")


def markdown(header: list[str], rows: list[list[str]]) -> None:
    print("| " + " | ".join(header) + " |")
    print("|---" + "|---:" * (len(header) - 1) + "|")
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def nees(program: str, nclt: str, sessions: list[str]) -> None:
    rows, steps = [], []
    for session in sessions:
        with tempfile.TemporaryDirectory() as folder:
            statistics = Path(folder) / "statistics.json"
            subprocess.run(
                [program, "--quiet", f"{nclt}/{session}", "--sigma-translation", SIGMAS[0]]
                + ["--sigma-rotation", SIGMAS[1], "-o", "/dev/null", "--stats", str(statistics)],
                check=True,
            )
            found = json.loads(statistics.read_text())
        steps = [window["steps"] for window in found["nees"]]
        rows.append([session, str(found["odometry"])])
        rows[-1] += [f"{window['per_degree_of_freedom']:.2f}" for window in found["nees"]]
    markdown(["session", "odometry"] + [f"{length} steps" if length > 1 else "1 step" for length in steps], rows)


def runs(table: str) -> dict[tuple[str, str, str, str], float]:
    with open(table, newline="") as file:
        keys = ("pipeline", "method", "session", "seed")
        return {tuple(row[key] for key in keys): float(row["rmse_m"]) for row in csv.DictReader(file)}


def difference(first: str, second: str) -> None:
    before, after = runs(first), runs(second)
    if before.keys() != after.keys():
        sys.exit(f"{first} and {second} are of different runs; make both with the same sessions, seeds and methods")
    rows = []
    for pipeline, method in sorted({run[:2] for run in before}):
        change = [after[run] - before[run] for run in before if run[:2] == (pipeline, method)]
        largest = max(change, key=abs)
        rows.append([f"{pipeline}, {method}", str(len(change)), f"{sum(change) / len(change):+.4f}", f"{largest:+.4f}"])
    markdown(["regime, method", "runs", "mean difference (m)", "largest difference (m)"], rows)


def main() -> None:
    match sys.argv[1:]:
        case ["nees", program, nclt, *sessions] if sessions:
            nees(program, nclt, sessions)
        case ["difference", first, second]:
            difference(first, second)
        case _:
            sys.exit(__doc__)


main()

#!/usr/bin/env python3
"""Times the paper's experiment on simulated sessions (20 seeds, 4 sessions, 5 methods, two threads), from nothing, and puts the
table into docs/experiments.md (--write). The programs must be built."""

import argparse
import json
import subprocess
import tempfile
from datetime import date
from pathlib import Path

from splice import splice

SEEDS = 20
METHODS = ["none", "pcm", "gc", "pcm+gc", "oracle"]
DOCUMENT = Path("docs/experiments.md")


def run(programs: Path, work: Path) -> tuple[dict, int]:
    """The statistics of a run, and how many results it left."""
    command = [programs / "posecut-experiment", "run", "pipelines/paper.toml", "--quiet", "--threads", "2",
               "--seeds", str(SEEDS), "--methods", ",".join(METHODS),
               "--results", work / "results", "--simulated", work / "simulated", "--stats", work / "stats.json"]
    subprocess.run([str(word) for word in command], check=True)
    return json.loads((work / "stats.json").read_text()), len(list(work.rglob("*.result.json")))


def table(stats: dict, results: int) -> str:
    stages = sorted(stats["stages"].items(), key=lambda item: -item[1]["seconds"])
    rows = [f"| {name} | {stage['tasks']} | {stage['seconds']:.1f} | {1000 * stage['seconds'] / stage['tasks']:.0f} |"
            for name, stage in stages]
    return "\n".join([
        f"{SEEDS} seeds, 4 simulated sessions, {len(METHODS)} methods ({', '.join(METHODS)}), from nothing, on 2 cores "
        f"({date.today()}): {stats['run']} tasks and {results} results in {stats['seconds']:.1f} s.",
        "Wall time of whole processes:", "",
        "| stage | calls | seconds | milliseconds a call |", "|---|---|---|---|", *rows, ""])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("programs", type=Path, nargs="?", default=Path("target/release"), help="their directory")
    parser.add_argument("--write", action="store_true", help="put the table into docs/experiments.md")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        text = table(*run(arguments.programs, Path(work)))
    print(text)
    if arguments.write:
        splice(DOCUMENT, "time", text)


main()

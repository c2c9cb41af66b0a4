#!/usr/bin/env python3
"""Times the paper's experiment on simulated sessions (20 seeds, 4 sessions, 5 methods, two threads), from nothing, and puts the
table into docs/experiments.md (--write). The programs must be built.
Usage: scripts/time-experiment.py [--write] [DIRECTORY_OF_PROGRAMS]"""

import json
import subprocess
import sys
import tempfile
from datetime import date
from pathlib import Path

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
    arguments = sys.argv[1:]
    write = "--write" in arguments
    programs = Path(next((word for word in arguments if word != "--write"), "target/release"))
    with tempfile.TemporaryDirectory() as work:
        text = table(*run(programs, Path(work)))
    print(text)
    if write:
        before, rest = DOCUMENT.read_text().split("<!-- begin: time -->\n", 1)
        _, after = rest.split("<!-- end: time -->", 1)
        DOCUMENT.write_text(f"{before}<!-- begin: time -->\n\n{text}\n<!-- end: time -->{after}")


main()

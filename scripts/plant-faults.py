#!/usr/bin/env python3
"""Plants three faults, each one changed line of a copy of the sources, holds the table of the copy's program to
pipelines/expected.toml, and puts what `make check-results` says into docs/experiments.md (--write). Exits with 1 if a fault is
not blamed on its stage."""

import argparse
import shutil
import subprocess
import sys
from pathlib import Path

from splice import splice

ROOT = Path(__file__).resolve().parent.parent
DOCUMENT = ROOT / "docs/experiments.md"
COPY = ROOT / "target/faulty"
WIDTH = 160
# Stage, file, what stands there once, and what takes its place.
FAULTS = [
    ("pcm", "crates/pcm/src/pairs/gate.rs", "let quantile = chi_square_quantile(probability, degrees_of_freedom)?;",
     "let quantile = 2.0 * chi_square_quantile(probability, degrees_of_freedom)?;"),
    ("multicut", "crates/multicut/src/stage.rs", "(_, 0) => -1.0,", "(_, 0) => 1.0,"),
    ("construct", "crates/construct/src/landmark.rs", "|&(from, to)| viewpoints[from].pose.between(&viewpoints[to].pose)",
     "|&(from, to)| viewpoints[to].pose.between(&viewpoints[from].pose)"),
]


def plant(stage: str, file: str, right: str, wrong: str) -> Path:
    """A program built from a copy of the sources with one line changed."""
    sources = COPY / "sources"
    shutil.rmtree(sources, ignore_errors=True)
    sources.mkdir(parents=True)
    for name in ["Cargo.toml", "Cargo.lock", "crates"]:
        source = ROOT / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, sources / name)
    text = (sources / file).read_text()
    if text.count(right) != 1:
        sys.exit(f"{file} has {text.count(right)} times, not once: {right}")
    (sources / file).write_text(text.replace(right, wrong))
    subprocess.run(["cargo", "build", "--release", "--locked", "--quiet", "-p", f"posecut-{stage}",
                    "--target-dir", str(COPY / "target")], cwd=sources, check=True)
    program = COPY / f"posecut-{stage}"
    shutil.copy(COPY / f"target/release/posecut-{stage}", program)
    return program.relative_to(ROOT)


def said(stage: str, program: Path) -> str:
    """What the check says of the table with this program in its stage's place."""
    results = (COPY / "results").relative_to(ROOT)
    shutil.rmtree(ROOT / results, ignore_errors=True)
    check = subprocess.run(["make", "check-results", "PIPELINES=paper", "SEEDS=1", f"RESULTS={results}", f"{stage.upper()}={program}"],
                           cwd=ROOT, capture_output=True, text=True)
    lines = (check.stdout + check.stderr).splitlines()
    start = next((place for place, line in enumerate(lines) if line.startswith("FAILED in stage")), None)
    if check.returncode == 0 or start is None or f"`{stage}`" not in lines[start]:
        print("\n".join(lines))
        sys.exit(f"the fault in {stage} is not blamed on it")
    end = next(place for place, line in enumerate(lines) if line.startswith("If the change is meant")) + 1
    return "\n".join(line if len(line) <= WIDTH else line[:WIDTH - 1] + "…" for line in lines[start:end])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="put what the check says into docs/experiments.md")
    parser.add_argument("stages", nargs="*", help="plant the faults of these alone: " + ", ".join(fault[0] for fault in FAULTS))
    arguments = parser.parse_args()
    for fault in (fault for fault in FAULTS if not arguments.stages or fault[0] in arguments.stages):
        text = said(fault[0], plant(*fault))
        print(text, end="\n\n")
        if arguments.write:
            splice(DOCUMENT, fault[0], f"```\n{text}\n```\n")


main()

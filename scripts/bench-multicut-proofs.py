#!/usr/bin/env python3
"""What proofs are made of: branchings, edges fixed, wheels packed, counted in the certificates of posecut-multicut.

Usage: scripts/bench-multicut-proofs.py [--program NAME=PATH]... [--time-limit SECONDS] [--write FILE]

Runs every program (default: the release build) on the small instances of $POSECUT_SHARED_DATA/multicut, on generated
graphs of 1,000 viewpoints, and on complete and on sparse random graphs with costs drawn evenly from -1 to 1. To see what a change
gains, name a build from before and one from after it. Each certificate is verified by the first program named. Prints a table in Markdown;
--write puts it between the markers `<!-- begin: wheels -->` and `<!-- end: wheels -->` of a file.
"""

import argparse
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile

from splice import splice

ROOT = pathlib.Path(__file__).resolve().parent.parent
LARGEST = 25_000


def draw(path, nodes, share, seed):
    chance = random.Random(seed)
    lines = ["MULTICUT"]
    for head in range(nodes):
        for tail in range(head):
            if chance.random() < share:
                lines.append(f"{tail} {head} {chance.uniform(-1, 1):.6f}")
    path.write_text("\n".join(lines) + "\n")


def instances(folder, target):
    data = os.environ.get("POSECUT_SHARED_DATA")
    if data:
        for path in sorted(pathlib.Path(data, "multicut").glob("*.mc")):
            if path.stat().st_size and sum(1 for _ in path.open()) < LARGEST:
                yield path.stem, path
    else:
        print("skipped: no data: multicut (set POSECUT_SHARED_DATA)", file=sys.stderr)
    for family, rate in (("A", "0.5"), ("A", "0.9"), ("D", "0.1"), ("D", "0.5")):
        path = folder / f"{family}{rate}.mc"
        subprocess.run([target / "examples/generate_mc", family, "1000", rate, "1", path], check=True)
        yield f"{family} n=1000 {rate}", path
    for nodes, share in ((20, 1.0), (30, 1.0), (40, 1.0), (60, 0.2), (120, 0.08)):
        for seed in (1, 2):
            path = folder / f"random-{nodes}-{seed}.mc"
            draw(path, nodes, share, seed)
            yield f"random, {nodes} nodes, {share:.0%}, seed {seed}", path


def proof(program, verifier, path, limit, folder):
    stats, certificate = folder / "stats.json", folder / "certificate"
    subprocess.run([program, "--format", "mc", path, "--time-limit", str(limit), "--threads", "1", "-q", "--stats", stats,
                    "--certificate", certificate, "-o", os.devnull], check=True)
    subprocess.run([verifier, "--format", "mc", path, "--verify", certificate, "-q"], check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)
    words = [line.split(" ", 1)[0] for line in certificate.open()]
    found = json.loads(stats.read_text())
    return (f"{words.count('branch')} | {words.count('fix')} | {words.count('wheel')} | {found['lower_bound']:.10g}"
            f"{'' if found['optimal'] else ' (open)'} | {found['work'] / 1e6:.3g}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", action="append", metavar="NAME=PATH")
    parser.add_argument("--time-limit", type=int, default=10)
    parser.add_argument("--write", type=pathlib.Path)
    arguments = parser.parse_args()
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release"
    programs = [text.split("=", 1) for text in arguments.program or [f"now={target / 'posecut-multicut'}"]]
    lines = ["| instance | " + " | ".join(f"{name}: branchings | fixings | wheels | bound | work, millions" for name, _ in programs) + " |",
             "|---|" + "---|" * (5 * len(programs))]
    same = 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for instance, path in instances(folder, target):
            cells = [proof(program, programs[0][1], path, arguments.time_limit, folder) for _, program in programs]
            kinds = {cell.rsplit(" | ", 1)[0] for cell in cells}
            if len(cells) > 1 and len(kinds) == 1 and "(open)" not in cells[0]:
                same += 1
                continue
            lines.append(f"| {instance} | " + " | ".join(cells) + " |")
            print(lines[-1], file=sys.stderr)
    if len(programs) > 1:
        lines += ["", f"On {same} other instances the proofs are alike."]
    text = "\n".join(lines)
    print(text)
    if arguments.write:
        splice(arguments.write, "wheels", text + "\n")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Measures posecut-pcm: seconds, memory, precision and recall on drawn scenarios.

Usage: scripts/measure-pcm.py bench [--sizes N...] [-o FILE]

Remakes the section of docs/results/pcm.md between `<!-- begin: bench -->` and `<!-- end: bench -->`, from the release programs. It can
run one size at a time: rows of other sizes stay. `make pcm-gates` remakes the table of graphs with false closures.
"""

import argparse
import datetime
import json
import os
import pathlib
import platform
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release"


def machine():
    model = platform.machine()
    cpuinfo = pathlib.Path("/proc/cpuinfo")
    if cpuinfo.exists():
        model = next((line.split(":")[1].strip() for line in cpuinfo.read_text().splitlines()
                      if line.startswith("model name")), model)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return f"{datetime.date.today()}, {os.cpu_count()} cores, {memory:.0f} GB, {model}"


def measured(command, threads):
    process = subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, text=True,
                               env=dict(os.environ, RAYON_NUM_THREADS=str(threads)))
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{command}: failed")
    return json.loads(output), usage.ru_maxrss / 1024


def scenarios(size):
    """What is drawn at a size: kind of false edges, their share, dimension."""
    for falsehood in ("uniform", "grouped", "near-miss"):
        for outliers in ("0.1", "0.5", "0.9"):
            for dimension in ("2", "3"):
                if dimension == "2" or (falsehood == "uniform" and size <= 5000):
                    yield falsehood, outliers, dimension


def bench(sizes, path):
    """Rows of the sizes given; those of other sizes stay as they are in the file."""
    rows = {}
    for line in section(path, "bench"):
        fields = [field.strip() for field in line.strip("|").split("|")]
        if fields[0].isdigit() and int(fields[0]) not in sizes:
            rows[(int(fields[0]), len(rows))] = line
    for size in sizes:
        for falsehood, outliers, dimension in scenarios(size):
            scheme = "cells" if size > 20_000 else "exact"
            command = [TARGET / "examples/measure", size, outliers, falsehood, dimension, scheme, 1]
            one, memory = measured(command, 1)
            both, _ = measured(command, 2)
            for key in ("clique", "grown", "precision", "recall", "nodes"):
                assert one[key] == both[key], (command, key)
            exact = scheme == "exact"
            proved = ("yes" if one["clique"] == one["upper_bound"] else f"at most {one['upper_bound']}") if exact else "–"
            pairs = [f"{figures['seconds_pairs']:.3f}" if exact else "–" for figures in (one, both)]
            rows[(size, len(rows))] = (
                f"| {size} | {outliers} | {falsehood} | {dimension} | {scheme} | {pairs[0]} | {pairs[1]} | "
                f"{100 * one['skipped']:.0f} | {one['seconds_clique']:.4f} | {both['seconds_clique']:.4f} | "
                f"{one['clique'] + one['grown']} | {proved} | {one['nodes']} | {memory:.0f} | {one['precision']:.4f} | "
                f"{one['recall']:.4f} |")
            print(rows[(size, len(rows) - 1)], file=sys.stderr)
    return [f"Measured {machine()}. Made by `scripts/measure-pcm.py bench`, a size at a time. Wall seconds with one thread "
            "and with two; skipped: pairs that the pre-test settled; clique: search and proof, by cells everything; memory of "
            "the whole process with the graph that it draws. Gate: 0.99 a pair.", "",
            "| candidates | false | kind | dim | scheme | pairs s, 1 thread | 2 threads | skipped % | clique s, 1 thread | "
            "2 threads | kept | proved | nodes | MB | precision | recall |", "|" + "---|" * 16,
            *(line for _, line in sorted(rows.items()))]


def section(path, name):
    """The lines between the markers of a section."""
    text = path.read_text()
    start, end = f"<!-- begin: {name} -->", f"<!-- end: {name} -->"
    if start not in text or end not in text:
        sys.exit(f"{path}: has no section {start} ... {end}")
    return text.split(start, 1)[1].split(end, 1)[0].strip("\n").split("\n")


def splice(path, name, lines):
    text = path.read_text()
    start, end = f"<!-- begin: {name} -->", f"<!-- end: {name} -->"
    if start not in text or end not in text:
        sys.exit(f"{path}: has no section {start} ... {end}")
    before, rest = text.split(start, 1)
    path.write_text(before + start + "\n\n" + "\n".join(lines) + "\n\n" + end + rest.split(end, 1)[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("section", choices=["bench"])
    parser.add_argument("--sizes", type=int, nargs="+", default=[100, 1000, 5000, 10_000, 20_000, 100_000])
    parser.add_argument("-o", "--output", type=pathlib.Path, default=ROOT / "docs/results/pcm.md")
    arguments = parser.parse_args()
    splice(arguments.output, "bench", bench(arguments.sizes, arguments.output))


if __name__ == "__main__":
    main()

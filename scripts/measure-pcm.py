#!/usr/bin/env python3
"""Measures posecut-pcm: precision and recall on graphs with false closures, and seconds on drawn ones.

Usage: scripts/measure-pcm.py data|bench [--sizes N...] [-o FILE]

Remakes the sections of docs/pcm-results.md between `<!-- NAME -->` and `<!-- /NAME -->`, from the release programs.
`bench` can be run a size at a time; rows of other sizes stay.
`data` needs $POSECUT_SHARED_DATA (or ../shared/data): false_closures/. Correct closures: by the labels (corrupted), by
ground truth within 2 m and 15 degrees (bicocca25b), by being in the clean graph too (pcm_two_robots).
"""

import argparse
import bisect
import csv
import datetime
import json
import math
import os
import pathlib
import platform
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release"
DATA = pathlib.Path(os.environ.get("POSECUT_SHARED_DATA", ROOT.parent / "shared/data")) / "false_closures"

GATES = [
    ("0.95", ["--probability", "0.95"]),
    ("0.99", ["--probability", "0.99"]),
    ("1 - 10^-6", ["--probability", "0.999999"]),
    ("0.99 a group", ["--probability", "0.99", "--correction", "group"]),
    ("root 0.99", ["--test", "root"]),
    ("threshold", ["--test", "threshold"]),
    ("0.99, grown", ["--grow", "0.999999"]),
    ("0.99, chance", ["--chance", "3"]),
    ("0.99, grown, chance", ["--grow", "0.999999", "--chance", "3"]),
    ("auto 0.95", ["--scale", "auto", "--probability", "0.95"]),
    ("auto 0.99", ["--scale", "auto"]),
    ("auto 1 - 10^-6", ["--scale", "auto", "--probability", "0.999999"]),
    ("auto 0.99, grown", ["--scale", "auto", "--grow", "0.99"]),
]
READMISSIONS = [
    ("0.99, re-admitted", ["--probability", "0.99"]),
    ("grown, re-admitted", ["--grow", "0.999999"]),
    ("grown, calibrated, re-admitted", ["--grow", "0.999999", "--calibrate"]),
]


def machine():
    model = platform.machine()
    cpuinfo = pathlib.Path("/proc/cpuinfo")
    if cpuinfo.exists():
        model = next((line.split(":")[1].strip() for line in cpuinfo.read_text().splitlines()
                      if line.startswith("model name")), model)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return f"{datetime.date.today()}, {os.cpu_count()} cores, {memory:.0f} GB, {model}"


def run(command, **more):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **more)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: {done.stderr.strip()}")
    return done.stdout


def converted(lines, folder, *options):
    """A g2o graph as JSON records; edges keep the order of the file by their ids."""
    path = folder / "graph.g2o"
    path.write_text("".join(lines))
    text = run([TARGET / "posecut-convert", "-q", path, "--to", "jsonl", *options])
    return [json.loads(line) for line in text.splitlines()]


def landmarks(records):
    return [record for record in records if record["kind"] == "landmark"]


def judged(path, correct):
    """Kept, correct kept, correct altogether of a graph that a stage has marked."""
    edges = landmarks(json.loads(line) for line in open(path))
    kept = [edge["id"] for edge in edges if "rejected_by" not in edge]
    return len(kept), sum(correct[edge] for edge in kept), sum(correct.values())


def share(part, whole):
    return part / whole if whole else 1.0


def cell(kept, right, all_correct):
    return f"{share(right, kept):.3f} / {share(right, all_correct):.3f}"


def table(rows, correct_of, folder, methods):
    """One row a graph, one column a method."""
    for name, records in rows:
        correct = correct_of(name, records)
        graph, out = folder / "graph.jsonl", folder / "out.jsonl"
        graph.write_text("".join(json.dumps(record) + "\n" for record in records))
        cells, scale, rounds = [], None, "–"
        for _, options in methods:
            stats = folder / "stats.json"
            run([TARGET / "posecut-pcm", "-q", graph, *options, "-o", out, "--stats", stats])
            cells.append(cell(*judged(out, correct)))
            figures = json.loads(stats.read_text())
            if "scale_odometry" in figures:
                scale = f"{figures['scale_odometry']:.2g}, {figures['scale_landmark']:.2g}"
        for _, options in READMISSIONS:
            try:
                run([ROOT / "pipelines/readmission.sh", "--pcm", TARGET / "posecut-pcm", "--optimize", TARGET / "posecut-optimize",
                     "--rounds", f"{out}.rounds", graph, out, *options])
                cells.append(cell(*judged(out, correct)))
            except SystemExit as error:
                print(error, file=sys.stderr)
                cells.append("failed")
        lines = pathlib.Path(f"{out}.rounds")
        if lines.exists():
            last = lines.read_text().split("\n")[:-1]
            rounds = f"{len(last)}"
        right = sum(correct.values())
        yield f"| {name} | {right} / {len(correct) - right} | {scale or '–'} | " + " | ".join(cells) + f" | {rounds} |"


def interpolated(times, truth, time):
    """The ground-truth pose at a time, linear between its neighbours (angles unwrapped)."""
    place = min(max(bisect.bisect_right(times, time), 1), len(times) - 1)
    a, b = truth[place - 1], truth[place]
    share_of_b = min(max((time - times[place - 1]) / (times[place] - times[place - 1]), 0.0), 1.0)
    turn = math.remainder(b[2] - a[2], 2 * math.pi)
    return (a[0] + share_of_b * (b[0] - a[0]), a[1] + share_of_b * (b[1] - a[1]), a[2] + share_of_b * turn)


def between(a, b):
    x, y = b[0] - a[0], b[1] - a[1]
    cosine, sine = math.cos(a[2]), math.sin(a[2])
    return (cosine * x + sine * y, cosine * y - sine * x, math.remainder(b[2] - a[2], 2 * math.pi))


def bicocca(folder):
    rows = [[float(field) for field in line.split(",")] for line in (DATA / "bicocca25b/ground_truth.csv").open()]
    times, truth = [row[0] for row in rows], [row[1:] for row in rows]
    stamps = [float(line) for line in (DATA / "bicocca25b/timestamps.txt").open() if line.strip()]

    def correct(_, records):
        verdicts = {}
        for edge in landmarks(records):
            poses = [interpolated(times, truth, stamps[edge[end]]) for end in ("from", "to")]
            error = between(edge["measurement"], between(*poses))
            near = math.hypot(error[0], error[1]) < 2 and abs(error[2]) < math.radians(15)
            verdicts[edge["id"]] = near
        return verdicts

    graphs = []
    for path in sorted((DATA / "bicocca25b").glob("B25b_*.g2o")):
        graphs.append((f"bicocca25b {path.stem[5:]}", converted(path.open().readlines(), folder)))
    return graphs, correct


def corrupted(folder):
    graphs, labels = [], {}
    for path in sorted((DATA / "corrupted").glob("*.g2o")):
        records = converted(path.open().readlines(), folder)
        edges = sorted((record for record in records if record["kind"] in ("odometry", "landmark")),
                       key=lambda record: record["id"])
        rows = list(csv.DictReader(path.with_suffix(".labels.csv").open()))
        assert len(edges) == len(rows), path
        for edge, row in zip(edges, rows):
            assert (edge["from"], edge["to"]) == (int(row["i"]), int(row["j"])), path
        labels[path.stem] = {edge["id"]: row["inlier"] == "1" for edge, row in zip(edges, rows)
                             if edge["kind"] == "landmark"}
        graphs.append((path.stem, records))
    return graphs, lambda name, _: labels[name]


def robots(folder):
    """All robots of an example in one graph; closures between robots stand in the files of both."""
    for example in sorted(path for path in (DATA / "pcm_two_robots").glob("*/*/example_*") if path.is_dir()):
        seen, lines = set(), []
        for path in sorted(example.glob("*.g2o"), key=lambda path: int(path.stem)):
            for line in path.open():
                if line.strip() and line not in seen:
                    seen.add(line)
                    lines.append(line if line.endswith("\n") else line + "\n")
        # One of the spoiled files has the end of a line a second time, as a line of its own.
        yield "/".join(example.parts[-3:]), converted(lines, folder, "--skip-unknown")


def robot_rows(folder):
    truth = None
    for name, records in robots(folder):
        edges = landmarks(records)
        key = {edge["id"]: (edge["from"], edge["to"], tuple(edge["measurement"])) for edge in edges}
        if name.startswith("clean"):
            truth = set(key.values())
        comparable = truth is not None and any(edge in truth for edge in key.values())
        graph, out, stats = folder / "graph.jsonl", folder / "out.jsonl", folder / "stats.json"
        graph.write_text("".join(json.dumps(record) + "\n" for record in records))
        cells = []
        for options in ([], ["--probability", "0.999999"], ["--test", "root"]):
            run([TARGET / "posecut-pcm", "-q", graph, *options, "-o", out, "--stats", stats])
            figures = json.loads(stats.read_text())
            assert figures["optimal"], "every clique is proved"
            text = str(figures["clique_size"])
            if comparable:
                correct = {edge: key[edge] in truth for edge in key}
                kept, right, everything = judged(out, correct)
                text += f" ({right} of {everything} clean, {kept - right} other)"
            cells.append(text)
        yield f"| {name} | {len(edges)} | {figures['groups']} | " + " | ".join(cells) + " |"


def data(folder):
    if not DATA.is_dir():
        sys.exit("skipped: no data: false_closures (set POSECUT_SHARED_DATA)")
    header = ("| graph | correct / wrong | scales | " + " | ".join(name for name, _ in GATES + READMISSIONS)
              + " | rounds |")
    lines = [f"Measured {machine()}. Precision / recall; made by `scripts/measure-pcm.py data`.", "", header,
             "|" + "---|" * (header.count("|") - 1)]
    for make in (bicocca, corrupted):
        graphs, correct = make(folder)
        for row in table(graphs, correct, folder, GATES):
            print(row, file=sys.stderr)
            lines.append(row)
    lines += ["", "Multi-robot examples: size of all cliques together at three gates.", "",
              "| example | closures | groups | 0.99 | 1 - 10^-6 | root 0.99 |", "|---|---|---|---|---|---|"]
    lines += robot_rows(folder)
    return lines


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
    start, end = f"<!-- {name} -->", f"<!-- /{name} -->"
    if start not in text or end not in text:
        sys.exit(f"{path}: has no section {start} ... {end}")
    return text.split(start, 1)[1].split(end, 1)[0].strip("\n").split("\n")


def splice(path, name, lines):
    text = path.read_text()
    start, end = f"<!-- {name} -->", f"<!-- /{name} -->"
    if start not in text or end not in text:
        sys.exit(f"{path}: has no section {start} ... {end}")
    before, rest = text.split(start, 1)
    path.write_text(before + start + "\n" + "\n".join(lines) + "\n" + end + rest.split(end, 1)[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("section", choices=["data", "bench"])
    parser.add_argument("--sizes", type=int, nargs="+", default=[100, 1000, 5000, 10_000, 20_000, 100_000])
    parser.add_argument("-o", "--output", type=pathlib.Path, default=ROOT / "docs/pcm-results.md")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        if arguments.section == "data":
            lines = data(pathlib.Path(name))
        else:
            lines = bench(arguments.sizes, arguments.output)
    splice(arguments.output, arguments.section, lines)


if __name__ == "__main__":
    main()

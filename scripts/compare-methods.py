#!/usr/bin/env python3
"""Compare all rejection methods on the same graphs, and splice the tables into docs/methods.md.

Usage: scripts/compare-methods.py DATA [FAMILY ...] [--method NAME ...]

FAMILY: paper, calibrated, bicocca, corrupted; all unless named. Measurements are kept in target/compare-methods/FAMILY.json;
with --method, those of the other methods are taken from there, and only the named ones are measured.

DATA holds nclt/ (sessions in NCLT's layouts) and false_closures/ (bicocca25b/, corrupted/). Every graph is made once; every
method marks its landmark edges; what is left is optimised without kernels; the poses are compared with those of the graph
without its incorrect edges. Precision and recall are those of the landmark edges left in use. The time is that of the
method alone, user and system seconds on all threads. Needs Python 3 and the programs, in target/release or in $PROGRAMS.
"""

import argparse
import bisect
import csv
import json
import math
import os
import resource
import signal
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

from splice import splice

ROOT = Path(__file__).resolve().parent.parent
PROGRAMS = Path(os.environ.get("PROGRAMS", ROOT / "target/release"))
DOCUMENT = ROOT / "docs/methods.md"
KEPT = ROOT / "target/compare-methods"
# CPU seconds on all threads after which a step of a method is ended; its cells then say so.
LIMIT = 60
# Of the random numbers of posecut-construct, so for the families of NCLT alone; the others are given graphs.
SEEDS = (1, 2, 3)
SESSIONS = ("2012-01-08", "2012-01-22", "2012-08-04", "2012-11-16", "2013-02-23")
# What pipelines/paper.toml and pipelines/calibrated.toml say.
SIGMAS = {"paper": ("0.3", "0.05"), "calibrated": ("0.1", "0.02")}
# Bicocca: correct is within 2 m and 15 degrees of the ground truth; frames come at 5 Hz, closures at 1 Hz.
CORRECT_DISTANCE, CORRECT_ANGLE = 2.0, math.radians(15)
# The ground truth is silent now and then; across more seconds than this nothing is interpolated.
LONGEST_SILENCE = 20.0
FRAMES = {"bicocca": {"multicut": ["--delta", "10"], "islands": ["--gap", "10"], "voting": ["--gap", "25"]}}

METHODS = {
    "none": [],
    "pcm": [["pcm"]],
    "pcm, chance": [["pcm", "--chance", "3"]],
    "gc": [["multicut"]],
    "pcm+gc": [["pcm"], ["multicut"]],
    "ransac": [["ransac"]],
    "ransac, sets of 2": [["ransac", "--set-size", "2"]],
    "densest": [["densest"]],
    "densest, rounded": [["densest", "--select", "rounded"]],
    "islands": [["islands"]],
    "voting": [["voting"]],
    "gnc": [["optimize", "--gnc", "--reject-below", "0.5"]],
    "dcs": [["optimize", "--kernel-landmark", "dcs", "--reject-below", "0.5"]],
    "oracle": [["oracle"]],
}


def run(arguments, limit=None):
    """Runs a stage; returns its CPU seconds, None if the limit ended it."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [str(PROGRAMS / f"posecut-{arguments[0]}"), "--quiet", *map(str, arguments[1:])]
    limited = limit and (lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5)))
    status = subprocess.run(command, preexec_fn=limited).returncode
    if status in (-signal.SIGXCPU, -signal.SIGKILL) and limit:
        return None
    if status:
        raise subprocess.CalledProcessError(status, command)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def relabel(path, correct, truth=None):
    """Writes `truth` to the landmark edges of a graph, and to its nodes where it is known."""
    lines = []
    for line in path.read_text().splitlines():
        record = json.loads(line)
        if record["kind"] == "landmark":
            record["truth"] = {"correct": correct(record)}
        if record["kind"] == "node" and truth and truth(record["id"]):
            record["truth"] = {"pose": list(truth(record["id"]))}
        lines.append(json.dumps(record))
    path.write_text("\n".join(lines) + "\n")


def nclt(regime, data, work):
    translation, rotation = SIGMAS[regime]
    for session in SESSIONS:
        ingested = work / "session.jsonl"
        run(["ingest", data / "nclt" / session, "--dimension", "2", "--keep-every", "10", "--sigma-translation",
             translation, "--sigma-rotation", rotation, "-o", ingested])
        for seed in SEEDS:
            path = work / f"{regime}-{session}-{seed}.jsonl"
            run(["construct", ingested, "--split", "middle", "--radius", "3", "--heading", "30", "--incorrect-rate", "0.1",
                 "--incorrect-distance", "10", "--landmark-sigma-translation", "0.1", "--landmark-sigma-rotation", "0.02",
                 "--seed", seed, "-o", path])
            yield session, path


def between(a, b):
    """The pose of b in the frame of a."""
    (xa, ya, ta), (xb, yb, tb) = a, b
    c, s, dx, dy = math.cos(ta), math.sin(ta), xb - xa, yb - ya
    return c * dx + s * dy, -s * dx + c * dy, math.remainder(tb - ta, math.tau)


def bicocca(data, work):
    folder = data / "false_closures/bicocca25b"
    rows = [tuple(map(float, row)) for row in csv.reader(open(folder / "ground_truth.csv"))]
    times = [row[0] for row in rows]
    stamps = [float(line) for line in open(folder / "timestamps.txt")]

    def truth(node):
        """The ground truth at a node's time, None where it is silent."""
        place = bisect.bisect(times, stamps[node]) if node < len(stamps) else 0
        if not 0 < place < len(times) or times[place] - times[place - 1] > LONGEST_SILENCE:
            return None
        (t0, x0, y0, a0), (t1, x1, y1, a1) = rows[place - 1], rows[place]
        share = (stamps[node] - t0) / (t1 - t0)
        return x0 + share * (x1 - x0), y0 + share * (y1 - y0), a0 + share * math.remainder(a1 - a0, math.tau)

    def correct(edge):
        ends = truth(edge["from"]), truth(edge["to"])
        if None in ends:
            return False
        x, y, angle = between(between(*ends), edge["measurement"])
        return math.hypot(x, y) < CORRECT_DISTANCE and abs(angle) < CORRECT_ANGLE

    for threshold in ("0.000", "0.150", "0.300", "0.500"):
        path = work / f"bicocca-{threshold}.jsonl"
        run(["convert", folder / f"B25b_{threshold}.g2o", "-o", path])
        relabel(path, correct, truth)
        yield threshold, path


def corrupted(data, work):
    folder = data / "false_closures/corrupted"
    for source in sorted(folder.glob("*.g2o")):
        labels = {}
        for row in csv.DictReader(open(source.with_suffix(".labels.csv"))):
            if row["kind"] == "loop":
                labels.setdefault((int(row["i"]), int(row["j"])), []).append(row["inlier"] == "1")
        path = work / f"{source.stem}.jsonl"
        run(["convert", source, "-o", path])
        # Several closures between two nodes stand in the same order in both files.
        relabel(path, lambda edge: labels[edge["from"], edge["to"]].pop(0))
        yield source.stem.replace("_", " "), path


def evaluate(path, steps, reference, family, work):
    """One method on one graph."""
    here, seconds = path, 0.0
    for number, step in enumerate(steps):
        there = work / f"step{number}.jsonl"
        spent = run([step[0], here, *step[1:], *FRAMES.get(family, {}).get(step[0], []), "-o", there], LIMIT)
        if spent is None:
            return None
        here, seconds = there, seconds + spent
    run(["optimize", here, "-o", work / "optimized.jsonl"])
    run(["evaluate", work / "optimized.jsonl", "--reference", reference, "-o", work / "result.json"])
    result = json.loads((work / "result.json").read_text())
    return {"rmse": result["rmse"], "seconds": seconds, "parts": result["components"], **result["edges"]}


def measure(name, graphs, methods, work):
    """{graph: {method: [one result a seed]}}, the methods that are not named from the time before."""
    kept = KEPT / f"{name}.json"
    found = json.loads(kept.read_text()) if kept.is_file() and methods != list(METHODS) else {}
    others = set(METHODS) - set(methods)
    if others and not (found and all(others <= set(results) for results in found.values())):
        sys.exit(f"{kept} has not all other methods of the table; measure {name} once without --method")
    for results in found.values():
        for method in methods:
            results.pop(method, None)
    for graph, path in graphs:
        run(["oracle", path, "-o", work / "oracle.jsonl"])
        run(["optimize", work / "oracle.jsonl", "-o", work / "reference.jsonl"])
        for method in methods:
            result = evaluate(path, METHODS[method], work / "reference.jsonl", name, work)
            found.setdefault(graph, {}).setdefault(method, []).append(result)
        print(f"  {path.stem}", file=sys.stderr, flush=True)
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps(found))
    return found


def shown(number):
    return f"{number:.3f}" if number < 1 else f"{number:.3g}" if number < 100 else f"{number:.0f}"


def table(graphs):
    """RMSE of every graph, then the edges."""
    names = list(graphs)
    lines = [["method", *names, "precision", "recall", "CPU s"]]
    for method in METHODS:
        cells, pooled, seconds = [], [0, 0, 0], []
        for name in names:
            results = graphs[name][method]
            if None in results:
                cells.append("–")
                continue
            cells.append(shown(sum(result["rmse"] for result in results) / len(results)))
            if any(result["parts"] > graphs[name]["oracle"][seed]["parts"] for seed, result in enumerate(results)):
                cells[-1] += " *"
            for result in results:
                counts = result["true_positive"], result["false_positive"], result["false_negative"]
                pooled = [total + count for total, count in zip(pooled, counts)]
                seconds.append(result["seconds"])
        true, false, lost = pooled
        precision = f"{true / (true + false):.4f}" if true + false else "–"
        recall = f"{true / (true + lost):.4f}" if true + lost else "–"
        lines.append([method, *cells, precision, recall, f"{sum(seconds) / max(1, len(seconds)):.2f}"])
    widths = [max(len(line[column]) for line in lines) for column in range(len(lines[0]))]
    lines.insert(1, ["-" * widths[0], *("-" * (width - 1) + ":" for width in widths[1:])])
    return "".join("| " + " | ".join(cell.ljust(widths[place]) if place == 0 else cell.rjust(widths[place])
                                     for place, cell in enumerate(line)) + " |\n" for line in lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("families", nargs="*", metavar="FAMILY")
    parser.add_argument("--method", dest="methods", metavar="NAME", action="append", choices=METHODS)
    arguments = parser.parse_args()
    if unknown := set(arguments.families) - set(FAMILIES):
        parser.error(f"no family is called {', '.join(sorted(unknown))}; there are {', '.join(FAMILIES)}")
    families = arguments.families or list(FAMILIES)
    for folder in sorted({folder for family in families for folder in FOLDERS[family]}):
        if not (arguments.data / folder).is_dir():
            parser.error(f"{arguments.data} has no folder {folder}; docs/methods.md says where the data come from")
    for family in families:
        with tempfile.TemporaryDirectory() as folder:
            work = Path(folder)
            splice(DOCUMENT, family, table(measure(family, FAMILIES[family](arguments.data, work), arguments.methods or list(METHODS), work)))


FOLDERS = {
    "paper": [f"nclt/{session}" for session in SESSIONS],
    "calibrated": [f"nclt/{session}" for session in SESSIONS],
    "bicocca": ["false_closures/bicocca25b"],
    "corrupted": ["false_closures/corrupted"],
}

FAMILIES = {
    "paper": partial(nclt, "paper"),
    "calibrated": partial(nclt, "calibrated"),
    "bicocca": bicocca,
    "corrupted": corrupted,
}

if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Times the incremental solver beside gtsam's ISAM2 and remakes the table in docs/results/incremental.md.

Both take a benchmark graph pose by pose, each with the edges that end at it, and give the estimate of the newest pose after
every step. "same" has gtsam's thresholds: relinearisation beyond 0.1 every 10 steps, propagation beyond 0.001, of all edges
at a pose beyond them. gtsam's gap is
2 error(estimate) over the lowest known cost; its prior on the first pose takes no part.

Usage: scripts/bench-incremental.py [--bench PROGRAM] [--write] [GRAPH...]
Needs gtsam (pip install gtsam) and POSECUT_SHARED_DATA; the machine should be idle.
"""

import argparse
import datetime
import importlib.metadata
import json
import os
import pathlib
import subprocess
import time

import gtsam

from splice import splice

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "results" / "incremental.md"
BEST = {"M3500": 137.914878247, "sphere2500": 1351.40192585, "city10000": 511.987450599}
SAME = ["translation=0.1", "rotation=0.1", "propagate=0.001", "error=0", "every=10", "iterations=1"]


def quantiles(seconds):
    ordered = sorted(seconds)
    pick = lambda share: 1e3 * ordered[round((len(ordered) - 1) * share)]
    return pick(0.5), pick(0.95), pick(0.99), pick(1.0)


def run_gtsam(path, spatial, skip):
    graph, _ = gtsam.readG2o(str(path), spatial)
    arrivals = {}
    for index in range(graph.size()):
        factor = graph.at(index)
        keys = factor.keys()
        arrivals.setdefault(max(keys), []).append((min(keys) + 1 != max(keys), index, keys[0], keys[1], factor))
    parameters = gtsam.ISAM2Params()
    parameters.setRelinearizeThreshold(0.1)
    parameters.relinearizeSkip = skip
    parameters.setOptimizationParams(gtsam.ISAM2GaussNewtonParams(0.001))
    isam = gtsam.ISAM2(parameters)
    if spatial:
        identity, dimension = gtsam.Pose3(), 6
        estimate_of, prior = isam.calculateEstimatePose3, gtsam.PriorFactorPose3
    else:
        identity, dimension = gtsam.Pose2(), 3
        estimate_of, prior = isam.calculateEstimatePose2, gtsam.PriorFactorPose2
    steps, inside = [], 0.0
    for key in range(max(arrivals) + 1):
        start = time.perf_counter()
        factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        if key == 0:
            factors.add(prior(0, identity, gtsam.noiseModel.Isotropic.Sigma(dimension, 1e-6)))
            values.insert(0, identity)
        for position, (_, _, first, second, factor) in enumerate(sorted(arrivals.get(key, []), key=lambda a: a[:2])):
            factors.push_back(factor)
            if position == 0:
                measured = factor.measured()
                other = second if first == key else first
                guess = estimate_of(other)
                guess = guess.compose(measured if second == key else measured.inverse())
                values.insert(key, guess)
        update = time.perf_counter()
        isam.update(factors, values)
        estimate_of(key)
        end = time.perf_counter()
        inside += end - update
        steps.append(end - start)
    cost = 2.0 * graph.error(isam.calculateEstimate())
    return {"total_s": inside, "quantiles": quantiles(steps), "cost": cost}


def run_ours(program, name, arguments):
    text = subprocess.run([program, name, *arguments], check=True, capture_output=True, text=True).stdout
    return json.loads(text)


def machine():
    """When, where and with what, in a line."""
    processor = next(line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name"))
    gigabytes = round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30)
    return (f"{datetime.date.today()}, {os.cpu_count()} cores ({processor}), {gigabytes} GB, "
            f"gtsam {importlib.metadata.version('gtsam')}; one thread each.")


def row(name, solver, total, quantile, gap, worst, polished):
    median, p95, p99, largest = quantile
    return f"| {name} | {solver} | {total:.2f} | {median:.3f} | {p95:.2f} | {p99:.2f} | {largest:.1f} | {gap:.1e} | {worst} | {polished} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bench", help="the built bench program; default: cargo bench")
    parser.add_argument("--write", action="store_true", help="remake the table of the page")
    parser.add_argument("graphs", nargs="*", default=list(BEST))
    options = parser.parse_args()
    data = pathlib.Path(os.environ["POSECUT_SHARED_DATA"]) / "g2o"
    program = options.bench
    if not program:
        built = subprocess.run(
            ["cargo", "bench", "-p", "posecut-optimize", "--bench", "incremental", "--no-run", "--message-format=json"],
            check=True, capture_output=True, text=True, cwd=ROOT).stdout
        names = [json.loads(line) for line in built.splitlines() if line.startswith("{")]
        program = [n["executable"] for n in names if n.get("executable") and n["target"]["name"] == "incremental"][-1]
    lines = [
        "| graph | solver | total s | median ms | p95 ms | p99 ms | max ms | gap at the end | worst gap at 10 checkpoints | gap after one full relinearisation |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    ratios = []
    for name in options.graphs:
        theirs = run_gtsam(data / f"{name}.g2o", name == "sphere2500", 10)
        lines.append(row(name, "gtsam ISAM2", theirs["total_s"], theirs["quantiles"], theirs["cost"] / BEST[name] - 1, "", ""))
        for label, arguments in [("posecut, same", [*SAME, "checkpoints=0"]), ("posecut, default", ["checkpoints=10"])]:
            ours = run_ours(program, name, arguments)
            worst = f"{ours['worst_checkpoint_gap']:.1e}" if label.endswith("default") else ""
            quantile = tuple(ours[f"{key}_ms"] for key in ("median", "p95", "p99", "max"))
            lines.append(row(name, label, ours["newest_s"], quantile, ours["gap"], worst, f"{ours['polished_gap']:.1e}"))
            ratios.append(f"{name}, {label}: {100 * ours['newest_s'] / theirs['total_s']:.0f} % of gtsam's time")
    table = machine() + "\n\n" + "\n".join(lines) + "\n\n" + "; ".join(ratios) + "."
    print(table)
    if options.write:
        splice(PAGE, "table", table + "\n")


if __name__ == "__main__":
    main()

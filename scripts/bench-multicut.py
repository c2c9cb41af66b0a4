#!/usr/bin/env python3
"""Measures posecut-multicut as a whole process on generated and published instances; writes docs/multicut-results.md.

Usage: scripts/bench-multicut.py [--largest N] [--peer PYTHON] [--time-limit SECONDS] [--generated-limit SECONDS] [-o FILE]

Builds the release program, generates graphs of the families F, S, A (10^3 to N viewpoints) and D (to 10^5) with 10, 50
and 90 % false edges, and adds every instance of $POSECUT_SHARED_DATA/multicut. With --peer, the Python of an
environment that has bioimage-cpp, its GAEC and GAEC + KL run on the same files. CPU seconds and peak memory are
those that the system counts for the whole process, reading and writing included, on one thread.
"""

import argparse
import datetime
import json
import os
import pathlib
import platform
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SEED = "1"


def measured(command, limit):
    """CPU seconds, peak memory in MB and standard output of a process; None if it fails or outlasts the limit."""
    process = subprocess.Popen(["timeout", str(limit), *map(str, command)], stdout=subprocess.PIPE,
                               stderr=subprocess.DEVNULL)
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        return None
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, output


def machine():
    model = platform.processor() or platform.machine()
    cpuinfo = pathlib.Path("/proc/cpuinfo")
    if cpuinfo.exists():
        model = next((line.split(":")[1].strip() for line in cpuinfo.read_text().splitlines()
                      if line.startswith("model name")), model)
    return f"{os.cpu_count()} cores, {model}, {platform.system()} {platform.machine()}"


def solve(program, path, solver, time_limit, folder):
    stats, labels = folder / "stats.json", folder / "labels"
    command = [program, "--format", "mc", path, "--solver", solver, "--time-limit", time_limit, "--threads", 1, "-q",
               "--stats", stats, "-o", labels]
    result = measured(command, 4 * time_limit + 60)
    if result is None:
        return None
    return {"cpu": result[0], "memory": result[1], **json.loads(stats.read_text())}


def number(value):
    return f"{value:.10g}"


def exact_row(name, s):
    if s is None:
        return f"| {name} | – | – | failed | | | | | |"
    share = 100 * s["kernel_edges"] / max(s["edges"], 1)
    return (f"| {name} | {s['nodes']} | {s['edges']} | {s['cpu']:.2f} | {s['memory']:.0f} | {number(s['objective'])} | "
            f"{number(s['lower_bound'])} | {'yes' if s['optimal'] else 'no'} | {share:.3g} |")


def peer_rows(name, program, peer, path, time_limit, peer_limit, folder):
    for solver in ("gaec", "klj"):
        ours = solve(program, path, solver, time_limit, folder)
        theirs = measured([peer, ROOT / "scripts/bench-multicut-peer.py", solver, path], peer_limit)
        if ours is None or theirs is None:
            mine, value = ("failed", "–") if ours is None else (f"{ours['cpu']:.2f}", number(ours["objective"]))
            yield f"| {name} | {solver} | {mine} | {value} | {'over ' + str(peer_limit) if theirs is None else '–'} | | | | |"
            continue
        peer_stats = json.loads(theirs[2])
        difference = ours["objective"] - peer_stats["objective"]
        # Sums in another order differ in the last digits.
        small = 1e-9 * max(1.0, abs(peer_stats["objective"]))
        word = "equal" if abs(difference) <= small else "better" if difference < 0 else "worse"
        yield (f"| {name} | {solver} | {ours['cpu']:.2f} | {number(ours['objective'])} | {theirs[0]:.2f} | "
               f"{peer_stats['solve_cpu_seconds']:.2f} | {number(peer_stats['objective'])} | "
               f"{peer_stats['solve_cpu_seconds'] / max(ours['cpu'], 1e-3):.2g} | {word} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--largest", type=int, default=10**6)
    parser.add_argument("--largest-peer", type=int, default=10**6)
    parser.add_argument("--peer")
    parser.add_argument("--time-limit", type=int, default=60, help="for each published instance")
    parser.add_argument("--generated-limit", type=int, default=60, help="for each generated instance")
    parser.add_argument("--peer-limit", type=int, default=120)
    parser.add_argument("-o", "--output", default=ROOT / "docs/multicut-results.md")
    arguments = parser.parse_args()
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    subprocess.run(["cargo", "build", "--release", "--locked", "-q", "-p", "posecut-multicut", "--bins", "--example",
                    "generate_mc"], cwd=ROOT, check=True)
    program, generator = target / "release/posecut-multicut", target / "release/examples/generate_mc"
    exact, peers = [], []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        jobs = []
        data = os.environ.get("POSECUT_SHARED_DATA")
        if data:
            jobs += [(path.stem, path, None) for path in sorted(pathlib.Path(data, "multicut").glob("*.mc"))]
        else:
            print("skipped: no data: multicut (set POSECUT_SHARED_DATA)", file=sys.stderr)
        sizes = [10**power for power in range(3, 7) if 10**power <= arguments.largest]
        for size in sizes:
            for family in "FSAD":
                for rate in ("0.1", "0.5", "0.9"):
                    if family != "D" or size <= 10**5:
                        jobs.append((f"{family} n={size} {rate}", folder / "instance.mc", (family, size, rate)))
        for name, path, drawn in jobs:
            print(name, file=sys.stderr)
            if drawn:
                family, size, rate = drawn
                subprocess.run([generator, family, str(size), rate, SEED, path], check=True)
            limit = arguments.generated_limit if drawn else arguments.time_limit
            exact.append(exact_row(name, solve(program, path, "exact", limit, folder)))
            if arguments.peer and (not drawn or size <= arguments.largest_peer):
                peers += peer_rows(name, program, arguments.peer, path, limit, arguments.peer_limit, folder)
    text = ["# What the multicut solver does", "", f"Measured {datetime.date.today()} on {machine()}, one thread. Made by:", "",
            "    scripts/bench-multicut.py " + " ".join(
                f"{option} {value}" for option, value in (("--largest", arguments.largest),
                                                           ("--largest-peer", arguments.largest_peer),
                                                           ("--peer-limit", arguments.peer_limit),
                                                           ("--generated-limit", arguments.generated_limit),
                                                           ("--time-limit", arguments.time_limit))) +
            (" --peer python" if arguments.peer else ""), "",
            "Family, n viewpoints in each of two sessions, share of false edges (`crates/multicut/src/generate.rs`); all others "
            "are published instances. CPU seconds and peak memory are the whole process's, reading included. *Share* is the "
            "percentage of edges that survive the reductions.", "",
            f"Proved optimal: {sum('| yes |' in row for row in exact)} of {len(exact)}. Value beside the peer's, where it ended in time: "
            + ", ".join(f"{sum(row.endswith(f' {word} |') for row in peers)} {word}" for word in ("better", "equal", "worse")) + ".",
            "", "## Exact", "",
            "| instance | nodes | edges | CPU s | MB | objective | lower bound | proved | share % |",
            "|---|---|---|---|---|---|---|---|---|", *exact, ""]
    if peers:
        text += ["## Heuristics beside bioimage-cpp", "",
                 "*Whole* counts the peer's Python start and reading, *solving* its solver alone; ours is always the whole process with "
                 "reading, writing and a lower bound. *Ratio* is the peer's solving over our whole: above 1, we are faster although we do "
                 "more. *Value* compares objectives.", "",
                 "| instance | solver | ours CPU s | ours value | peer whole s | peer solving s | peer value | ratio | value |",
                 "|---|---|---|---|---|---|---|---|---|", *peers, ""]
    pathlib.Path(arguments.output).write_text("\n".join(text))


if __name__ == "__main__":
    main()

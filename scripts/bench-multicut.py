#!/usr/bin/env python3
"""Measures posecut-partition, the multicut solver, as a whole process on generated and published instances; writes docs/results/multicut.md.

Usage: scripts/bench-multicut.py [--largest N] [--peer PYTHON] [--time-limit SECONDS] [--generated-limit SECONDS]
                                 [--measured FILE] [--only TEXT] [--for SECONDS] [-o FILE]

Builds the release program, generates graphs of the families F, S, A (10^3 to N viewpoints) and D (to 10^5) with 10, 50
and 90 % false edges, and adds every instance of $POSECUT_SHARED_DATA/multicut. With --peer, the Python of an
environment that has bioimage-cpp, its GAEC and GAEC + KL run on the same files. CPU seconds and peak memory are
those that the system counts for the whole process, reading and writing included, on one thread. --measured keeps what
was measured, one JSON object an instance, so that a run cut short by --for goes on where it ended.
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
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
SEED = "1"
RATES = ("0.1", "0.5", "0.9")


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
    command = [program, "solve", path, "--solver", solver, "--time-limit", time_limit, "--threads", 1, "-q",
               "--stats", stats, "-o", labels]
    result = measured(command, 4 * time_limit + 60)
    if result is None:
        return None
    return {"cpu": result[0], "memory": result[1], **json.loads(stats.read_text())}


def number(value):
    return f"{value:.10g}"


def measure(name, program, peer, path, limit, peer_limit, folder):
    """All that the tables say about one instance."""
    found = {"name": name, "exact": solve(program, path, "exact", limit, folder), "peer": {}}
    if peer:
        for solver in ("gaec", "klj"):
            theirs = measured([peer, ROOT / "scripts/bench-multicut-peer.py", solver, path], peer_limit)
            if theirs:
                theirs = {"cpu": theirs[0], "memory": theirs[1], **json.loads(theirs[2])}
            found["peer"][solver] = (solve(program, path, solver, limit, folder), theirs)
    return found


def exact_row(found):
    name, s = found["name"], found["exact"]
    if s is None:
        return f"| {name} | – | – | failed | | | | | |"
    share = 100 * s["kernel_edges"] / max(s["edges"], 1)
    return (f"| {name} | {s['nodes']} | {s['edges']} | {s['cpu']:.2f} | {s['memory']:.0f} | {number(s['objective'])} | "
            f"{number(s['lower_bound'])} | {'yes' if s['optimal'] else 'no'} | {share:.3g} |")


def percent(share):
    return "100 %" if share >= 0.995 else f"{100 * share:.2g} %"


def compare(ours, theirs):
    """better, equal or worse."""
    difference = ours["objective"] - theirs["objective"]
    # Sums in another order differ in the last digits.
    small = 1e-9 * max(1.0, abs(theirs["objective"]))
    return "equal" if abs(difference) <= small else "better" if difference < 0 else "worse"


def peer_rows(found, peer_limit):
    for solver, (ours, theirs) in found["peer"].items():
        start = f"| {found['name']} | {solver} | "
        if ours is None or theirs is None:
            mine = "failed | –" if ours is None else f"{ours['cpu']:.3f} | {number(ours['objective'])}"
            yield start + f"{mine} | {'over ' + str(peer_limit) if theirs is None else '–'} | | | | |"
            continue
        yield (start + f"{ours['cpu']:.3f} | {number(ours['objective'])} | {theirs['cpu']:.3f} | "
               f"{theirs['solve_cpu_seconds']:.3f} | {number(theirs['objective'])} | "
               f"{theirs['cpu'] / max(ours['cpu'], 1e-3):.2g} | {compare(ours, theirs)} |")


def growth(results):
    """CPU seconds, memory and share of surviving edges of the generated instances, a column a size."""
    drawn = {tuple(found["name"].split()): found["exact"] for found in results if " n=" in found["name"]}
    sizes = sorted({key[1] for key in drawn}, key=lambda size: int(size[2:]))
    yield "| family | false | " + " | ".join(sizes) + " |"
    yield "|---|---|" + "---|" * len(sizes)
    for family in "FSAD":
        for rate in RATES:
            cells = []
            for size in sizes:
                s = drawn.get((family, size, rate))
                cells.append("" if s is None else f"{s['cpu']:.2f} s, {s['memory']:.0f} MB, "
                             f"{percent(s['kernel_edges'] / max(s['edges'], 1))}, "
                             + ("proved" if s["optimal"] else f"gap {percent(s['gap'] / abs(s['objective']))}"))
            yield f"| {family} | {rate} | " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--largest", type=int, default=10**6)
    parser.add_argument("--largest-peer", type=int, default=10**6)
    parser.add_argument("--peer")
    parser.add_argument("--time-limit", type=int, default=60, help="for each published instance")
    parser.add_argument("--generated-limit", type=int, default=60, help="for each generated instance")
    parser.add_argument("--peer-limit", type=int, default=120)
    parser.add_argument("--measured", type=pathlib.Path, help="keep measurements in this file, and use those in it")
    parser.add_argument("--only", default="", metavar="TEXT", help="only instances with this text in their names")
    parser.add_argument("--for", type=float, default=float("inf"), dest="seconds", help="measure nothing new after this many seconds")
    parser.add_argument("-o", "--output", default=ROOT / "docs/results/multicut.md")
    arguments = parser.parse_args()
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    subprocess.run(["cargo", "build", "--release", "--locked", "-q", "-p", "posecut-partition", "-p", "posecut-multicut",
                    "--bins", "--example", "generate_mc"], cwd=ROOT, check=True)
    program, generator = target / "release/posecut-partition", target / "release/examples/generate_mc"
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
                for rate in RATES:
                    if family != "D" or size <= 10**5:
                        jobs.append((f"{family} n={size} {rate}", folder / "instance.mc", (family, size, rate)))
        known = {}
        if arguments.measured and arguments.measured.exists():
            known = {found["name"]: found for found in map(json.loads, arguments.measured.read_text().splitlines())}
        results = []
        end = time.monotonic() + arguments.seconds
        for name, path, drawn in jobs:
            if arguments.only in name and name not in known and time.monotonic() < end:
                print(name, file=sys.stderr)
                if drawn:
                    family, size, rate = drawn
                    subprocess.run([generator, family, str(size), rate, SEED, path], check=True)
                peer = arguments.peer if not drawn or size <= arguments.largest_peer else None
                limit = arguments.generated_limit if drawn else arguments.time_limit
                known[name] = measure(name, program, peer, path, limit, arguments.peer_limit, folder)
                if arguments.measured:
                    with arguments.measured.open("a") as file:
                        print(json.dumps(known[name]), file=file)
            if name in known:
                results.append(known[name])
    missing = [job[0] for job in jobs if arguments.only in job[0] and job[0] not in known]
    exact = [exact_row(found) for found in results]
    peers = [row for found in results for row in peer_rows(found, arguments.peer_limit)]
    pairs = [pair for found in results for pair in found["peer"].values() if None not in pair]
    words = [compare(*pair) for pair in pairs]
    faster = sum(ours["cpu"] < theirs["cpu"] for ours, theirs in pairs)
    faster_alone = sum(ours["cpu"] < theirs["solve_cpu_seconds"] for ours, theirs in pairs)
    text = ["# What the multicut solver does", "",
            f"The solver proves {sum('| yes |' in row for row in exact)} of {len(exact)} instances optimal." + (
                f" In the {len(pairs)} runs that bioimage-cpp finished in time, posecut's value is "
                + ", ".join(f"{word} in {words.count(word)}" for word in ("better", "equal", "worse"))
                + f". Its whole process, with lower bound, is faster than the whole process of bioimage-cpp in {faster} runs, and than "
                f"the solver of bioimage-cpp alone in {faster_alone}."
                if pairs else ""), "",
            f"Measured {datetime.date.today()} on {machine()}, one thread. Made by:", "",
            "    scripts/bench-multicut.py " + " ".join(
                f"{option} {value}" for option, value in (("--largest", arguments.largest),
                                                           ("--largest-peer", arguments.largest_peer),
                                                           ("--peer-limit", arguments.peer_limit),
                                                           ("--generated-limit", arguments.generated_limit),
                                                           ("--time-limit", arguments.time_limit))) +
            (" --peer python" if arguments.peer else ""), "",
            "Generated instances are named by family, number n of viewpoints in each of two sessions, and share of false edges "
            "(`crates/multicut/src/graph/generate.rs`). All others are published. CPU seconds and peak memory are those of the whole "
            "process, reading included. *Share* is the percentage of edges that survive the reductions. Limits are wall time, so the gap "
            "of an instance that is not proved depends on what else the machine did; compare its CPU seconds.",
            *(["", "Not measured: " + ", ".join(missing) + "."] if missing else []),
            "", "## Growth", "",
            "A cell shows CPU seconds, peak memory, the share of edges that survive the reductions, and the gap relative to the objective.", "",
            *growth(results),
            "", "## Exact", "",
            "| instance | nodes | edges | CPU s | MB | objective | lower bound | proved | share % |",
            "|---|---|---|---|---|---|---|---|---|", *exact, ""]
    if peers:
        text += ["## Heuristics beside bioimage-cpp", "",
                 "The peer is bioimage-cpp. CPU seconds are those of whole processes. posecut's process reads, reduces, solves, computes a "
                 "lower bound and writes. The peer's process starts Python, reads and solves. *Peer solver s* is the time of its solver alone, "
                 "with the graph in memory. *Ratio* compares processes: above 1, posecut is faster. *Value* compares objectives.", "",
                 "| instance | solver | CPU s | objective | peer CPU s | peer solver s | peer objective | ratio | value |",
                 "|---|---|---|---|---|---|---|---|---|", *peers, ""]
    pathlib.Path(arguments.output).write_text("\n".join(text))


if __name__ == "__main__":
    main()

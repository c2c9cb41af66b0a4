#!/usr/bin/env python3
"""Measures posecut-verify beside posecut-pcm: seconds and memory of whole processes.

Usage: scripts/measure-verify.py speed [--sizes N...] [--repeats N] [--limit SECONDS] [--nclt DIR] [-o FILE]

Remakes the sections of docs/results/verify-speed.md between `<!-- begin: NAME -->` and `<!-- end: NAME -->`, from the
release programs and `cargo build --release -p posecut-pcm --example draw`. A size can be measured at a time; rows of
other sizes stay. Size 41142 is five whole NCLT sessions where DIR holds them (default: $POSECUT_SHARED_DATA or
../shared/data, nclt/), else a drawn graph. A process is stopped after --limit seconds.
"""

import argparse
import datetime
import os
import pathlib
import platform
import signal
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAMS = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release"
DATA = pathlib.Path(os.environ.get("POSECUT_SHARED_DATA", ROOT.parent / "shared/data")) / "nclt"
PAGE = ROOT / "docs/results/verify-speed.md"

FIVE_SESSIONS = 41_142
GOALS = {1000: 0.05, 5000: 0.5, FIVE_SESSIONS: 8.0, 100_000: 15.0}
METHODS = [
    ("verify", ["posecut-verify"]),
    ("pcm", ["posecut-pcm"]),
    ("pcm --chance 3", ["posecut-pcm", "--chance", "3"]),
]


def machine():
    model = platform.machine()
    cpuinfo = pathlib.Path("/proc/cpuinfo")
    if cpuinfo.exists():
        model = next((line.split(":")[1].strip() for line in cpuinfo.read_text().splitlines()
                      if line.startswith("model name")), model)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return f"{os.cpu_count()} cores, {memory:.0f} GB, {model}"


def run(command, **more):
    done = subprocess.run([str(word) for word in command], stderr=subprocess.PIPE, text=True, **more)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: {done.stderr.strip()}")


def drawn(candidates, outliers, kind, path):
    with path.open("w") as output:
        run([PROGRAMS / "examples/draw", candidates, outliers, kind, 2, 1], stdout=output)


def five_sessions(sessions, folder, path):
    """Five whole sessions; correct edges within 3 m, a tenth of all edges false."""
    graphs = []
    for session in sessions:
        graphs.append(folder / f"{session.name}.jsonl")
        if not graphs[-1].exists():
            run([PROGRAMS / "posecut-ingest", "-q", session, "-o", graphs[-1]])
    run([PROGRAMS / "posecut-construct", "-q", *graphs, "--split", "none", "--radius", "3", "--incorrect-rate", "0.1",
         "--incorrect-distance", "10", "--seed", "1", "-o", path])


def graphs(size, nclt, folder):
    """Names and files of the graphs of a size."""
    sessions = sorted(path for path in nclt.glob("20*") if path.is_dir())[:5] if nclt.is_dir() else []
    if size == FIVE_SESSIONS and len(sessions) == 5:
        path = folder / "five.jsonl"
        five_sessions(sessions, folder, path)
        yield "five NCLT sessions, 10 % uniform", path
        return
    for kind in ("uniform", "grouped"):
        path = folder / f"{size}.{kind}.jsonl"
        drawn(size, 0.3, kind, path)
        yield f"drawn, 30 % {kind}", path


def measured(command, limit):
    """Wall seconds, CPU seconds and peak MB of a process; None where it was stopped."""
    start = time.monotonic()
    with tempfile.TemporaryFile("w+") as said:
        process = subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL, stderr=said)
        while True:
            done, status, usage = os.wait4(process.pid, os.WNOHANG)
            seconds = time.monotonic() - start
            if done:
                break
            if seconds > limit:
                process.kill()
                os.wait4(process.pid, 0)
                process.returncode = -signal.SIGKILL
                return None
            time.sleep(0.0005 if seconds < 1 else 0.01)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            said.seek(0)
            sys.exit(f"{' '.join(map(str, command))}: {said.read().strip()}")
    return seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def row(size, name, path, repeats, limit):
    """A row of the table: medians over the repeats, the methods by turns so that a busy machine meets all of them."""
    found = {method: [] for method, _ in METHODS}
    for _ in range(repeats):
        for method, command in METHODS:
            if None not in found[method]:
                found[method].append(measured([PROGRAMS / command[0], "-q", path, *command[1:], "-o", os.devnull], limit))

    def median(method, figure):
        values = found[method]
        return None if None in values else statistics.median(value[figure] for value in values)

    def seconds(value):
        return f"> {limit:.0f}" if value is None else f"{value:.3f}" if value < 10 else f"{value:.1f}"

    cells = [seconds(median(method, 0)) for method, _ in METHODS]
    cells += [seconds(median(method, 1)) for method, _ in METHODS]
    own = median("verify", 1)
    for method, _ in METHODS[1:]:
        other = median(method, 1)
        cells.append("–" if own is None or other is None else f"{own / other:.1f}")
    goal, wall = GOALS.get(size), median("verify", 0)
    cells.append("–" if goal is None else f"{goal:g}")
    cells.append("–" if goal is None else "yes" if wall is not None and wall <= goal else "no")
    memory = median("verify", 2)
    cells.append("–" if memory is None else f"{memory:.0f}")
    return f"| {size} | {name} | " + " | ".join(cells) + f" | {repeats} | {os.getloadavg()[0]:.0f} | {datetime.date.today()} |"


def markers(name):
    return f"<!-- begin: {name} -->", f"<!-- end: {name} -->"


def section(path, name):
    """The lines between the markers of a section."""
    text = path.read_text()
    start, end = markers(name)
    if start not in text or end not in text:
        sys.exit(f"{path}: has no section {start} ... {end}")
    return text.split(start, 1)[1].split(end, 1)[0].strip("\n").split("\n")


def splice(path, name, lines):
    text = path.read_text()
    start, end = markers(name)
    before, rest = text.split(start, 1)
    path.write_text(before + start + "\n\n" + "\n".join(lines) + "\n\n" + end + rest.split(end, 1)[1])


def speed(arguments):
    rows = {}
    for line in section(arguments.output, "speed"):
        fields = [field.strip() for field in line.strip("|").split("|")]
        if fields[0].isdigit() and int(fields[0]) not in arguments.sizes:
            rows[(int(fields[0]), len(rows))] = line
    with tempfile.TemporaryDirectory() as name:
        for size in arguments.sizes:
            for title, path in graphs(size, arguments.nclt, pathlib.Path(name)):
                rows[(size, len(rows))] = row(size, title, path, arguments.repeats, arguments.limit)
                print(rows[(size, len(rows) - 1)], file=sys.stderr)
    methods = [method for method, _ in METHODS]
    heads = ["candidates", "graph", *(f"{method}, s" for method in methods), *(f"{method}, CPU s" for method in methods),
             *(f"verify / {method}" for method in methods[1:]), "goal, s", "reached", "verify, MB", "repeats", "load", "date"]
    return [f"Measured on {machine()}.", "", "| " + " | ".join(heads) + " |", "|" + "---:|" * len(heads),
            *(line for _, line in sorted(rows.items()))]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("section", choices=["speed"])
    parser.add_argument("--sizes", type=int, nargs="+", default=list(GOALS))
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--limit", type=float, default=120.0)
    parser.add_argument("--nclt", type=pathlib.Path, default=DATA)
    parser.add_argument("-o", "--output", type=pathlib.Path, default=PAGE)
    arguments = parser.parse_args()
    splice(arguments.output, arguments.section, speed(arguments))


if __name__ == "__main__":
    main()

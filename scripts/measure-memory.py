#!/usr/bin/env python3
"""Measures peak resident memory and seconds of every program on the largest input that is sensible for it.

Usage: scripts/measure-memory.py [--only NAME...]    remakes the table of docs/results/memory.md and the lines of READMEs
       scripts/measure-memory.py --check             a tenth of each input: memory may not exceed twice what the table foretells

Needs the release programs. Graphs are drawn here, with a fixed seed: two sessions on one route, a landmark edge for every
tenth node, a fifth of them incorrect. Rows of programs that are not measured again stay.
"""

import argparse
import datetime
import math
import os
import pathlib
import platform
import random
import re
import subprocess
import sys
import tempfile
import time

from splice import splice

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAMS = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release"
PAGE = ROOT / "docs/results/memory.md"

# What a process takes before it reads anything, with its threads and buffers.
BASE = 16 * 2**20
MARGIN = 2
# Seconds after which a program has run away; no measurement of time.
LIMIT = 600

# Program, arguments, kind of input, its size. The million is the largest graph that is sensible; where a method takes
# minutes on it, the size is less.
CASES = [
    ("simulate", ["--rate", "40", "--overwrite"], "metres", 100_000),
    ("ingest", [], "session", 100_000),
    ("construct", ["--radius", "3", "--incorrect-rate", "0.2"], "session graph", 100_000),
    ("convert", ["--to", "g2o"], "graph", 1_000_000),
    ("label", [], "graph", 1_000_000),
    ("oracle", [], "graph", 1_000_000),
    ("inspect", ["info"], "graph", 1_000_000),
    ("islands", [], "graph", 1_000_000),
    ("pcm", [], "graph", 1_000_000),
    ("verify", [], "graph", 100_000),
    ("ransac", [], "graph", 1_000_000),
    ("multicut", [], "graph", 1_000_000),
    ("optimize", [], "clean graph", 1_000_000),
    ("evaluate", [], "graph", 1_000_000),
    ("densest", [], "graph", 20_000),
    ("voting", [], "graph", 20_000),
    ("report", ["table"], "results", 100_000),
    ("experiment", ["plan"], "seeds", 20_000),
    ("conform", ["--"], "program", 1),
]


def machine():
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return f"{os.cpu_count()} cores, {memory:.0f} GB, {platform.machine()}"


def wrapped(angle):
    return math.atan2(math.sin(angle), math.cos(angle))


def between(a, b):
    """The pose b seen from a."""
    cosine, sine = math.cos(a[2]), math.sin(a[2])
    x, y = b[0] - a[0], b[1] - a[1]
    return [cosine * x + sine * y, cosine * y - sine * x, wrapped(b[2] - a[2])]


def moved(a, by):
    cosine, sine = math.cos(a[2]), math.sin(a[2])
    return [a[0] + cosine * by[0] - sine * by[1], a[1] + sine * by[0] + cosine * by[1], wrapped(a[2] + by[2])]


def drawn_graph(nodes, path):
    """Two sessions of half the nodes each, on one route."""
    draw = random.Random(1)
    noisy = lambda motion, sigmas: [value + draw.gauss(0, sigma) for value, sigma in zip(motion, sigmas)]
    length = nodes // 2
    truth = [[0.0, 0.0, 0.0]]
    for step in range(length - 1):
        truth.append(moved(truth[-1], [1.0, 0.0, 0.1 * math.sin(step / 40) + 0.002]))
    text = lambda values: "[" + ",".join(f"{value:.6f}" for value in values) + "]"
    with path.open("w") as file:
        file.write('{"kind":"header","format":"posecut","version":1,"dimension":2,"noise_models":{'
                   '"odometry":{"information":[400,0,0,400,0,40000]},"landmark":{"information":[100,0,0,100,0,2500]}}}\n')
        edges = []
        for session in range(2):
            pose = [0.0, 0.0, 0.0]
            for frame in range(length):
                identity = session * length + frame
                if frame:
                    motion = noisy(between(truth[frame - 1], truth[frame]), (0.05, 0.05, 0.005))
                    pose = moved(pose, motion)
                    edges.append(f'{{"kind":"odometry","id":{len(edges)},"from":{identity - 1},"to":{identity},'
                                 f'"measurement":{text(motion)},"noise":"odometry"}}\n')
                file.write(f'{{"kind":"node","id":{identity},"session":"{"ab"[session]}","frame":{frame},'
                           f'"pose":{text(pose)},"truth":{{"pose":{text(truth[frame])}}}}}\n')
        for candidate in range(nodes // 10):
            first, correct = draw.randrange(length), draw.random() > 0.2
            second = min(length - 1, max(0, first + draw.randrange(-2, 3))) if correct else draw.randrange(length)
            measured = noisy(between(truth[first], truth[second]) if correct else [0.0, 0.0, 0.0], (0.1, 0.1, 0.02))
            edges.append(f'{{"kind":"landmark","id":{len(edges)},"from":{first},"to":{length + second},'
                         f'"measurement":{text(measured)},"noise":"landmark","truth":{{"correct":{str(correct).lower()}}}}}\n')
        file.writelines(edges)


def drawn_apart(nodes, path):
    """In a process of its own: a program's peak includes what this process held when it started the program."""
    child = os.fork()
    if child == 0:
        drawn_graph(nodes, path)
        os._exit(0)
    if os.waitpid(child, 0)[1] != 0:
        sys.exit(f"{path}: cannot be drawn")


def run(program, arguments):
    """Peak bytes and seconds of a process that must succeed."""
    words = [str(PROGRAMS / f"posecut-{program}"), *map(str, arguments)]
    with tempfile.TemporaryFile() as said:
        began = time.monotonic()
        child = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=said)
        while True:
            ended, status, usage = os.wait4(child.pid, os.WNOHANG)
            if ended:
                break
            if time.monotonic() - began > LIMIT:
                child.kill()
                os.wait4(child.pid, 0)
                sys.exit(f"{' '.join(words)}: takes more than {LIMIT} s; measure a smaller input")
            time.sleep(0.005)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode not in (0, 1):
            said.seek(0)
            sys.exit(f"{' '.join(words)}: {said.read().decode(errors='replace').strip()}")
    return usage.ru_maxrss * 1024, time.monotonic() - began


class Inputs:
    """Inputs by kind and size, each made once, in a folder of their own."""

    def __init__(self, folder):
        self.folder = folder

    def session(self, metres):
        path = self.folder / f"{metres}" / "2012-01-22"
        if not path.exists():
            run("simulate", ["-q", "--length", metres, "--rate", 40, "-o", path])
        return path

    def file(self, kind, size):
        path = self.folder / f"{kind.replace(' ', '-')}.{size}.jsonl"
        if path.exists():
            return path
        if kind == "graph":
            drawn_apart(size, path)
        elif kind == "clean graph":
            # A least-squares solver is for graphs whose incorrect edges are gone.
            run("oracle", ["-q", self.file("graph", size), "--drop-rejected", "-o", path])
        elif kind == "session graph":
            run("ingest", ["-q", self.session(size), "-o", path])
        elif kind == "results":
            small, result = self.folder / "small.jsonl", self.folder / "one.result.json"
            drawn_apart(200, small)
            run("evaluate", ["-q", small, "--label", "method=none", "--label", "session=a", "--label", "seed=1", "-o", result])
            line = re.sub(r"\s*\n\s*", " ", result.read_text()).strip()
            with path.open("w") as file:
                for number in range(size):
                    file.write(re.sub('"seed": ?1', f'"seed":{number}', line) + "\n")
        return path

    def arguments(self, kind, size):
        """What a program is given, and the bytes that it reads."""
        output = self.folder / "output"
        if kind == "metres":
            return ["--length", size, "-o", self.folder / "2012-01-22"], 0
        if kind == "session":
            path = self.session(size)
            return [path, "-o", output], sum(file.stat().st_size for file in path.iterdir())
        if kind == "seeds":
            declaration = self.folder / "memory.toml"
            declaration.write_text('sessions = ["one"]\nmethods = ["none"]\n[method]\nnone = []\noracle = ["oracle"]\n')
            stages = ROOT / "pipelines/stages.toml"
            return [declaration, "--seeds", size, "--stages", stages, "-o", output], declaration.stat().st_size
        if kind == "program":
            return [PROGRAMS / "posecut-oracle"], 0
        path = self.file(kind, size)
        return [path, "-o", output], path.stat().st_size


def measure(case, inputs, share=1):
    program, options, kind, size = case
    given, read = inputs.arguments(kind, max(1, size // share))
    peak, seconds = run(program, ["--threads", 2, *options, *given] if program != "conform" else [*options, *given])
    return peak, seconds, read


def rows():
    """The rows of the page, by program."""
    found = {}
    for line in PAGE.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("| ") and cells[0].startswith("posecut-"):
            found[cells[0].removeprefix("posecut-")] = cells
    return found


def check(inputs):
    """Whether memory on a tenth of the input is within the bound that the page states."""
    stated, wrong = rows(), []
    for case in CASES:
        program, _, kind, size = case
        peak, _, _ = measure(case, inputs, 10)
        bound = MARGIN * (BASE + float(stated[program][4]) * max(1, size // 10))
        print(f"{program:11} {size // 10:8} {kind:14} {peak / 2**20:8.1f} MB, bound {bound / 2**20:8.1f} MB")
        if peak > bound:
            wrong.append(program)
    if wrong:
        sys.exit(f"more memory than docs/results/memory.md allows: {', '.join(wrong)}")


def record(names, inputs):
    found = rows()
    date = datetime.date.today().isoformat()
    for case in CASES:
        program, options, kind, size = case
        if names and program not in names:
            continue
        peak, seconds, read = measure(case, inputs)
        arguments = " ".join(word for word in options if word not in ("--overwrite", "--"))
        size_text = f"{size} {UNITS[kind]}"
        found[program] = [f"posecut-{program}", f"`{arguments}`" if arguments else "", size_text, f"{read / 2**20:.0f}",
                          f"{max(0, peak - BASE) / size:.0f}", f"{peak / 2**20:.0f}", f"{seconds:.1f}", date]
        print(" | ".join(found[program]), flush=True)
    head = ["program", "options", "input", "input, MB", "bytes for each", "peak, MB", "seconds", "date"]
    lines = ["| " + " | ".join(head) + " |", "|---|---|---:|---:|---:|---:|---:|---|"]
    lines += ["| " + " | ".join(found[name]) + " |" for name, *_ in CASES if name in found]
    splice(PAGE, "memory", f"Measured on {machine()}.\n\n" + "\n".join(lines) + "\n")
    for name, cells in found.items():
        readme = ROOT / f"crates/{name}/README.md"
        if "<!-- begin: memory -->" not in readme.read_text():
            continue
        options = f" with {cells[1]}" if cells[1] else ""
        splice(readme, "memory", f"Memory and time: {cells[5]} MB and {cells[6]} s for {cells[2]}{options} ({cells[7]}, "
               f"{os.cpu_count()} cores): [docs/results/memory.md](../../docs/results/memory.md).\n")


UNITS = {"metres": "m of driving", "session": "m of driving", "session graph": "m of driving", "graph": "nodes", "clean graph": "nodes, correct edges alone",
         "results": "results", "seeds": "seeds", "program": "program"}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--only", nargs="*", default=[], choices=[case[0] for case in CASES])
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        inputs = Inputs(pathlib.Path(folder))
        check(inputs) if arguments.check else record(arguments.only, inputs)


if __name__ == "__main__":
    main()

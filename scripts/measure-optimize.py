#!/usr/bin/env python3
"""Measures posecut-optimize, beside other optimisers too, and remakes the tables of docs/results/optimize.md.

Usage: scripts/measure-optimize.py [--only GRAPH,...] [--parts peers,process,growth,robust,phases] [--no-measure]

Wants POSECUT_SHARED_DATA (the graphs in g2o/ and false_closures/), the programs in target/release, for the part `growth`
`cargo build --release -p posecut-optimize --benches`, and for the part `peers` crates/optimize/peers built to target/peers or to
the folder that PEERS names, and gtsam in target/python, where scripts/check-with-gtsam.sh installs it. The part `phases` measures
what the processor gives at most, by numpy in the same place, and shows beside it what `process` found. Every process is held to one
processor. Results gather in target/comparison.json, so that a long measurement can be made in parts.
"""
import argparse, json, math, os, re, subprocess, sys, time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROGRAMS = ROOT / "target/release"
WORK = ROOT / "target/comparison"
RESULTS = ROOT / "target/comparison.json"
PAGE = ROOT / "docs/results/optimize.md"
GTSAM = ROOT / "target/python/bin/python"
PEERS = Path(os.environ.get("PEERS", ROOT / "target/peers")) / "release/posecut-optimize-peers"
SOLVERS = ["posecut", "arael", "factrs", "apex", "tiny", "gtsam"]
LIMIT = float(os.environ.get("LIMIT", 40))  # seconds a process may take
# Poses of the largest generated graph that is measured with two threads, too.
MOST_WITH_TWO = int(os.environ.get("MOST_WITH_TWO", 300_000))
# Share above the best known cost at which a solver has found that minimum: of its own cost, which is not quite ours.
FOUND = 1e-2
GRAPHS = {
    name: float(cost.replace("_", ""))
    for name, cost in re.findall(
        r'\("(\w[\w-]*)", ([\d_.]+)\)', (ROOT / "crates/optimize/tests/g2o/best_known.rs").read_text()
    )
}


def gtsam_main(source, target, repeats):
    """Runs in gtsam's Python: Gauss-Newton with its defaults; prints a line like the other solvers'."""
    import gtsam

    spatial = "EDGE_SE3" in Path(source).read_text()
    graph, start = gtsam.readG2o(source, spatial)
    noise = gtsam.noiseModel.Isotropic.Sigma(6 if spatial else 3, 1e-3)
    first = min(start.keys())
    if spatial:
        graph.add(gtsam.PriorFactorPose3(first, start.atPose3(first), noise))
    else:
        graph.add(gtsam.PriorFactorPose2(first, start.atPose2(first), noise))
    best, total = math.inf, 0.0
    for _ in range(int(repeats)):
        clock = time.perf_counter()
        optimizer = gtsam.GaussNewtonOptimizer(graph, start, gtsam.GaussNewtonParams())
        try:
            result, iterations = optimizer.optimize(), optimizer.iterations()
        except RuntimeError:  # an indeterminate system
            result, iterations = start, None
        seconds = time.perf_counter() - clock
        best, total = min(best, seconds), total + seconds
        if total > 3:
            break
    gtsam.writeG2o(graph, result, target)
    print(json.dumps({"seconds": best, "iterations": iterations}))


def run(command, threads=1):
    """Standard output and wall seconds of a process on as many processors, or why there are none."""
    clock = time.perf_counter()
    process = subprocess.Popen(
        ["taskset", "-c", f"0-{threads - 1}", *map(str, command)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=dict(os.environ, RAYON_NUM_THREADS=str(threads), OPENBLAS_NUM_THREADS="1"),
    )
    try:
        out, error = process.communicate(timeout=LIMIT)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return {"failed": f"over {LIMIT:.0f} s"}
    wall = time.perf_counter() - clock
    if process.returncode != 0:
        return {"failed": (error.strip().splitlines() or ["no word"])[-1][:200]}
    return {"out": out, "wall": wall}


def measured(command):
    """As `run`, with the peak of memory, by GNU time."""
    peak = WORK / "peak"
    result = run(["/usr/bin/time", "-f", "%M", "-o", peak, *command])
    if "out" in result:
        result["megabytes"] = int(peak.read_text().split()[-1]) / 1024
    return result


def must(command, threads=1):
    result = run(command, threads)
    if "failed" in result:
        sys.exit(f"{command}: {result['failed']}")
    return result


def peak():
    """What one core gives in large dense products, Gflop/s, and in sums of two long vectors, Gbyte/s: the best of five, by numpy."""
    program = """
import json, time, numpy as np
def best(work):
    work()
    times = []
    for _ in range(5):
        clock = time.perf_counter(); work(); times.append(time.perf_counter() - clock)
    return min(times)
n, m = 2000, 20_000_000
a, b, c = np.random.rand(n, n), np.random.rand(n, n), np.empty((n, n))
x, y, z = np.ones(m), np.ones(m), np.zeros(m)
print(json.dumps({"gigaflops": 2e-9 * n**3 / best(lambda: np.matmul(a, b, out=c)), "gigabytes": 24e-9 * m / best(lambda: np.add(x, y, out=z))}))
"""
    return json.loads(must([GTSAM, "-c", program])["out"])


def cost_of(path):
    """The cost of a g2o graph's poses in the log convention, as posecut-optimize computes it; None if they are not finite."""
    stats, graph = WORK / "cost.json", WORK / "cost.jsonl"
    if "failed" in run([PROGRAMS / "posecut-convert", "-q", path, "-o", graph]):
        return None
    result = run([PROGRAMS / "posecut-optimize", "-q", "--initialisation", "given", "--max-iterations", 0, graph,
                  "-o", WORK / "cost.out.jsonl", "--stats", stats])
    return None if "failed" in result else json.loads(stats.read_text())["chi2_given"]


def starts(name):
    """The graph in g2o from the file's poses, from odometry and from the chordal relaxation, vertices from 0 in order."""
    graph = WORK / f"{name}.jsonl"
    must([PROGRAMS / "posecut-convert", "-q", Path(os.environ["POSECUT_SHARED_DATA"]) / f"g2o/{name}.g2o", "-o", graph])
    lines = [json.loads(line) for line in graph.read_text().splitlines()]
    number = {line["id"]: place for place, line in enumerate(line for line in lines if line["kind"] == "node")}
    for line in lines:
        if line["kind"] == "node":
            line["id"] = number[line["id"]]
        elif "from" in line:
            line["from"], line["to"] = number[line["from"]], number[line["to"]]
    graph.write_text("".join(json.dumps(line) + "\n" for line in lines))
    found = {}
    for start, initialisation in (("file", "given"), ("odometry", "spanning-tree"), ("chordal", "chordal")):
        poses, found[start] = WORK / f"{name}.{start}.jsonl", WORK / f"{name}.{start}.g2o"
        must([PROGRAMS / "posecut-optimize", "-q", "--initialisation", initialisation, "--max-iterations", 0, graph, "-o", poses])
        must([PROGRAMS / "posecut-convert", "-q", poses, "-o", found[start]])
    return found


def peers(name, results):
    """All solvers on one graph, one after the other, from every start."""
    for start, path in starts(name).items():
        for solver in SOLVERS:
            program = GTSAM if solver == "gtsam" else PEERS
            if not program.exists():
                sys.exit(f"{solver}: {program} is not there; build or install it first (see the top of this script)")
            target = WORK / f"{name}.{start}.{solver}.g2o"
            repeats = 10 if solver in ("posecut", "arael") else 3
            # From the relaxation, which the others do not have, posecut starts as they do.
            word = "posecut-given" if (solver, start) == ("posecut", "chordal") else solver
            head = [GTSAM, __file__, "--gtsam"] if solver == "gtsam" else [PEERS, word]
            result = measured([*head, path, target, repeats])
            if "out" in result:
                said = json.loads(result["out"].splitlines()[-1])
                result = {**said, "megabytes": result["megabytes"], "cost": cost_of(target)}
            results.setdefault("peers", {}).setdefault(name, {}).setdefault(start, {})[solver] = result
            print(name, start, solver, result, flush=True)


def whole_process(name, results):
    source = Path(os.environ["POSECUT_SHARED_DATA"]) / f"g2o/{name}.g2o"
    graph = WORK / f"{name}.jsonl"
    must([PROGRAMS / "posecut-convert", "-q", source, "-o", graph])
    odometry = WORK / f"{name}.odometry.jsonl"
    must([PROGRAMS / "posecut-optimize", "-q", "--initialisation", "spanning-tree", "--max-iterations", 0, graph, "-o", odometry])
    entry = {"poses": sum('"kind":"node"' in line.replace(" ", "") for line in graph.read_text().splitlines())}
    for word, start, options in (("plain", graph, []), ("odometry", odometry, []), ("certify", graph, ["--certify"]),
                                 ("marginals", graph, ["--marginals", "all"])):
        stats = WORK / "stats.json"
        best = {"wall": math.inf}
        for _ in range(3):
            result = measured([PROGRAMS / "posecut-optimize", "-q", *options, start, "-o", WORK / "out.jsonl", "--stats", stats])
            if "failed" in result:
                sys.exit(f"{name}: {result['failed']}")
            best = min(best, result, key=lambda run: run["wall"])
        said = json.loads(stats.read_text())
        entry[word] = {"seconds": best["wall"], "megabytes": best["megabytes"], "certificate": said.get("certificate"), "cost": said["chi2"],
                       "blocks": said["factor_blocks"], "flops": said["factor_flops"],
                       **{key: said[key] for key in said if key.endswith("_seconds")},
                       "iterations": said["iterations"], "factorizations": said["factorizations"],
                       "termination": said["termination"], "start": said["start"]}
    results.setdefault("process", {})[name] = entry
    print(name, entry, flush=True)


def growth(results, only):
    programs = (path for path in (ROOT / "target/release/deps").glob("growth-*") if not path.suffix)
    bench = max(programs, key=lambda path: path.stat().st_mtime)
    for kind, sizes in (("manhattan", [1000, 10_000, 100_000, 300_000, 1_000_000]), ("sphere", [1000, 10_000, 30_000, 100_000, 300_000, 1_000_000])):
        for size in (size for size in sizes if not only or size in only):
            result = run([bench, kind, size])
            entry = json.loads(result["out"]) if "out" in result else result
            if "out" in result and size <= MOST_WITH_TWO:
                entry["with_two"] = json.loads(must([bench, kind, size], threads=2)["out"])["seconds"]
            results.setdefault("growth", {}).setdefault(kind, {})[str(size)] = entry
            RESULTS.write_text(json.dumps(results, indent=1))
            print(kind, size, entry, flush=True)
            if "failed" in entry:
                break


MODES = {
    "plain": [],
    "Huber": ["--kernel-landmark", "huber"],
    "Cauchy": ["--kernel-landmark", "cauchy"],
    "Geman-McClure": ["--kernel-landmark", "geman-mcclure"],
    "DCS": ["--kernel-landmark", "dcs"],
    "GNC": ["--gnc"],
    "GNC (Geman-McClure)": ["--gnc=geman-mcclure"],
}


def robust(results, only):
    folder = Path(os.environ["POSECUT_SHARED_DATA"]) / "false_closures/corrupted"
    for source in sorted(path for path in folder.glob("*.g2o") if not only or path.stem in only):
        graph = WORK / "corrupted.jsonl"
        must([PROGRAMS / "posecut-convert", "-q", source, "-o", graph])
        lines = [json.loads(line) for line in graph.read_text().splitlines()]
        labels = [line.split(",") for line in source.with_suffix(".labels.csv").read_text().splitlines()[1:]]
        edges = [line for line in lines if line["kind"] in ("odometry", "landmark")]
        for edge, label in zip(edges, labels, strict=True):
            assert (edge["from"], edge["to"]) == (int(label[0]), int(label[1])), source
            edge["kind"] = "odometry" if label[2] == "odom" else "landmark"
        write = lambda path: path.write_text("".join(json.dumps(line) + "\n" for line in lines))
        write(graph)
        for edge, label in zip(edges, labels):
            if label[3] != "1":
                edge["rejected_by"] = "truth"
        write(WORK / "clean.jsonl")

        def positions(path, options):
            out = WORK / "robust.jsonl"
            result = run([PROGRAMS / "posecut-optimize", "-q", *options, path, "-o", out])
            if "failed" in result:
                return None
            records = map(json.loads, out.read_text().splitlines())
            return [record["pose"][:2] for record in records if record["kind"] == "node"]

        reference = positions(WORK / "clean.jsonl", [])
        row = {}
        for mode, options in MODES.items():
            found = positions(graph, options)
            row[mode] = found and math.sqrt(sum(math.dist(a, b) ** 2 for a, b in zip(found, reference)) / len(reference))
        results.setdefault("robust", {})[source.stem] = row
        RESULTS.write_text(json.dumps(results, indent=1))
        print(source.stem, row, flush=True)


def gap_of(entry, best):
    cost = entry.get("cost")
    return math.inf if cost is None or not math.isfinite(cost) else (cost - best) / best


def peers_rows(results):
    rows = ["| graph | poses | start | " + " | ".join(SOLVERS) + " | fastest peer / posecut |", "|---|---|---|" + "---|" * (len(SOLVERS) + 1)]
    factors = []
    for name, by_start in results.get("peers", {}).items():
        best = GRAPHS[name]
        poses = sum(line.startswith("VERTEX") for line in (WORK / f"{name}.file.g2o").read_text().splitlines())
        for start, entries in by_start.items():
            cells = []
            for solver in SOLVERS:
                entry = entries[solver]
                gap = gap_of(entry, best)
                if "failed" in entry or not math.isfinite(gap):
                    cells.append(entry.get("failed", "fails") if "over" in entry.get("failed", "") else "fails")
                    continue
                steps = "" if entry["iterations"] is None else f"{entry['iterations']}, "
                text = f"{1e3 * entry['seconds']:.3g} ms ({steps}{gap:.0e}, {entry['megabytes']:.0f} MB)"
                cells.append(text if gap < FOUND else f"*{text}*")
            times = [entries[solver]["seconds"] for solver in SOLVERS[1:] if gap_of(entries[solver], best) < FOUND]
            factor = f"{min(times) / entries['posecut']['seconds']:.2f}" if times else "none gets there"
            rows.append(f"| {name} | {poses} | {start} | " + " | ".join(cells) + f" | {factor} |")
            if poses >= 1000 and start != "chordal":
                factors.append((min(times) / entries["posecut"]["seconds"] if times else math.inf, f"{name} from {start}"))
    met = [factor for factor, _ in factors if factor < math.inf]
    least = ", ".join(f"{row} {factor:.2f}" for factor, row in sorted(factors)[:3])
    rows += ["", f"Graphs of 1000 poses and more, from the file's poses and from odometry, are {len(factors)} rows. In {len(factors) - len(met)} no peer gets "
             f"there; in {sum(factor >= 2 for factor in met)} posecut is at least twice as fast as the fastest peer that does, in "
             f"{sum(1 <= factor < 2 for factor in met)} faster by less, in {sum(factor < 1 for factor in met)} slower. The lowest factors: {least}."]
    return rows


def phases_rows(results):
    peak = results["peak"]
    phases = ["analysis", "start", "linearisation", "factorisation", "substitution"]
    rows = ["| graph | optimisation, ms | " + " | ".join(phases) + " | Mflop a factorisation | Gflop/s | of the peak |", "|---|---|" + "---|" * (len(phases) + 3)]
    for name, entry in results.get("process", {}).items():
        plain = entry["plain"]
        rate = 1e-9 * plain["flops"] * plain["factorizations"] / plain["factorisation_seconds"]
        cells = [f"{1e3 * plain[phase + '_seconds']:.2f}" for phase in phases]
        rows.append(f"| {name} | {1e3 * plain['optimize_seconds']:.2f} | " + " | ".join(cells) + f" | {1e-6 * plain['flops']:.1f} | {rate:.1f} | {rate / peak['gigaflops']:.0%} |")
    rows += ["", f"One core gives {peak['gigaflops']:.0f} Gflop/s in dense products of order 2000 and {peak['gigabytes']:.0f} Gbyte/s in sums of long vectors (numpy)."]
    return rows


def tables(results):
    out = {"peers": peers_rows(results)}
    if "peak" in results and all("flops" in entry["plain"] for entry in results.get("process", {}).values()):
        out["phases"] = phases_rows(results)
    rows = ["| graph | poses | cost | best known | gap | from odometry: gap | start | steps (factorisations) | ended by | whole process, s (MB) "
            "| with --certify, s | verdict | with --marginals all, s |",
            "|---|---|---|---|---|---|---|---|---|---|---|---|---|"]
    for name, entry in results.get("process", {}).items():
        plain, odometry, certify, marginals = (entry[word] for word in ("plain", "odometry", "certify", "marginals"))
        best = GRAPHS[name]
        rows.append(f"| {name} | {entry['poses']} | {plain['cost']:.12g} | {best:.12g} | {(plain['cost'] - best) / best:.0e} | "
                    f"{(odometry['cost'] - best) / best:.0e} | {plain['start']} | {plain['iterations']} ({plain['factorizations']}) | "
                    f"{plain['termination']} | {plain['seconds']:.3f} ({plain['megabytes']:.0f}) | {certify['seconds']:.3f} | "
                    f"{certify['certificate']} | {marginals['seconds']:.3f} |")
    out["process"] = rows
    rows = ["| graph | poses | edges | s | with two threads, s | peak MB | factor, blocks per pose | factor, MB | steps (factorisations) | start | chi2 per freedom |",
            "|---|---|---|---|---|---|---|---|---|---|---|"]
    for kind, sizes in results.get("growth", {}).items():
        for size, e in sizes.items():
            if "failed" in e:
                rows.append(f"| {kind} | {int(size):,} | | {e['failed']} | | | | | | | |")
                continue
            rows.append(f"| {kind} | {e['poses']:,} | {e['edges']:,} | {e['seconds']:.3f} | "
                        f"{'' if 'with_two' not in e else format(e['with_two'], '.3f')} | {e['peak_megabytes']:.0f} | "
                        f"{e['factor_blocks'] / e['poses']:.1f} | {e['factor_megabytes']:.1f} | {e['iterations']} ({e['factorizations']}) | "
                        f"{e['start']} | {e['chi2_per_freedom']:.3f} |")
    out["growth"] = rows
    rows = ["| graph | " + " | ".join(MODES) + " |", "|---|" + "---|" * len(MODES)]
    for name, row in results.get("robust", {}).items():
        rows.append(f"| {name} | " + " | ".join("fails" if row[mode] is None else f"{row[mode]:.3f}" for mode in MODES) + " |")
    out["robust"] = rows
    text = PAGE.read_text()
    for part, rows in out.items():
        if part in results or (part == "phases" and "process" in results):
            marker = re.compile(rf"(<!-- begin: {part} -->\n).*?(<!-- end: {part} -->)", re.S)
            assert marker.search(text), f"{PAGE} has no place for {part}"
            text = marker.sub(lambda match: match[1] + "\n" + "\n".join(rows) + "\n\n" + match[2], text)
    PAGE.write_text(text)


def main():
    if sys.argv[1:2] == ["--gtsam"]:
        return gtsam_main(*sys.argv[2:])
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", type=lambda text: text.split(","), help="graphs, by name")
    parser.add_argument("--parts", type=lambda text: text.split(","), default=["peers", "process", "growth", "robust", "phases"])
    parser.add_argument("--sizes", type=lambda text: [int(size) for size in text.split(",")], help="of generated graphs, those of so many poses")
    parser.add_argument("--no-measure", action="store_true", help="remake the tables from what was measured before")
    arguments = parser.parse_args()
    WORK.mkdir(parents=True, exist_ok=True)
    results = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    names = arguments.only or list(GRAPHS)
    for name in names if "peers" in arguments.parts and not arguments.no_measure else []:
        peers(name, results)
        RESULTS.write_text(json.dumps(results, indent=1))
    for name in names if "process" in arguments.parts and not arguments.no_measure else []:
        whole_process(name, results)
        RESULTS.write_text(json.dumps(results, indent=1))
    if "phases" in arguments.parts and not arguments.no_measure:
        results["peak"] = peak()
        RESULTS.write_text(json.dumps(results, indent=1))
    for part, measure in (("growth", lambda results: growth(results, arguments.sizes)), ("robust", lambda results: robust(results, arguments.only))):
        if part in arguments.parts and not arguments.no_measure:
            measure(results)
            RESULTS.write_text(json.dumps(results, indent=1))
    tables(results)


if __name__ == "__main__":
    main()

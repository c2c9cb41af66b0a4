#!/usr/bin/env python3
"""Measures posecut-optimize and remakes the tables of docs/optimize-results.md.

Usage: scripts/measure-optimize.py [--only GRAPH,...] [--parts process,growth,robust] [--no-measure]

Wants POSECUT_SHARED_DATA (the graphs in g2o/ and false_closures/), the programs in target/release and, for the part `growth`,
`cargo build --release -p posecut-optimize --benches`. Every process is held to one processor. Results gather in
target/comparison.json, so that a long measurement can be made in parts.
"""
import argparse, json, math, os, re, subprocess, sys, time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROGRAMS = ROOT / "target/release"
WORK = ROOT / "target/comparison"
RESULTS = ROOT / "target/comparison.json"
PAGE = ROOT / "docs/optimize-results.md"
LIMIT = 40.0  # seconds a process may take
GRAPHS = {
    name: float(cost.replace("_", ""))
    for name, cost in re.findall(
        r'\("(\w[\w-]*)", ([\d_.]+)\)', (ROOT / "crates/optimize/tests/g2o/best_known.rs").read_text()
    )
}


def run(command):
    """Standard output, wall seconds and peak megabytes of a process on one processor; None if it failed or took too long."""
    clock = time.perf_counter()
    process = subprocess.Popen(
        ["taskset", "-c", "0", *map(str, command)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=dict(os.environ, RAYON_NUM_THREADS="1"),
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


def must(command):
    result = run(command)
    if "failed" in result:
        sys.exit(f"{command}: {result['failed']}")
    return result


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
                       "iterations": said["iterations"], "factorizations": said["factorizations"],
                       "termination": said["termination"], "start": said["start"]}
    results.setdefault("process", {})[name] = entry
    print(name, entry, flush=True)


def growth(results):
    programs = (path for path in (ROOT / "target/release/deps").glob("growth-*") if not path.suffix)
    bench = max(programs, key=lambda path: path.stat().st_mtime)
    for kind, sizes in (("manhattan", [1000, 10_000, 100_000, 1_000_000]), ("sphere", [1000, 10_000, 30_000, 100_000])):
        for size in sizes:
            result = run([bench, kind, size])
            entry = json.loads(result["out"]) if "out" in result else result
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


def robust(results):
    folder = Path(os.environ["POSECUT_SHARED_DATA"]) / "false_closures/corrupted"
    for source in sorted(folder.glob("*.g2o")):
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


def tables(results):
    out = {}
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
    rows = ["| graph | poses | edges | s | peak MB | factor, blocks per pose | factor, MB | steps (factorisations) | start | chi2 per freedom |",
            "|---|---|---|---|---|---|---|---|---|---|"]
    for kind, sizes in results.get("growth", {}).items():
        for size, e in sizes.items():
            if "failed" in e:
                rows.append(f"| {kind} | {int(size):,} | | {e['failed']} | | | | | | |")
                continue
            rows.append(f"| {kind} | {e['poses']:,} | {e['edges']:,} | {e['seconds']:.3f} | {e['peak_megabytes']:.0f} | "
                        f"{e['factor_blocks'] / e['poses']:.1f} | {e['factor_megabytes']:.1f} | {e['iterations']} ({e['factorizations']}) | "
                        f"{e['start']} | {e['chi2_per_freedom']:.3f} |")
    out["growth"] = rows
    rows = ["| graph | " + " | ".join(MODES) + " |", "|---|" + "---|" * len(MODES)]
    for name, row in results.get("robust", {}).items():
        rows.append(f"| {name} | " + " | ".join("fails" if row[mode] is None else f"{row[mode]:.3f}" for mode in MODES) + " |")
    out["robust"] = rows
    text = PAGE.read_text()
    for part, rows in out.items():
        if part in results:
            marker = re.compile(rf"(<!-- {part} -->\n).*?(<!-- end of {part} -->)", re.S)
            assert marker.search(text), f"{PAGE} has no place for {part}"
            text = marker.sub(lambda match: match[1] + "\n" + "\n".join(rows) + "\n\n" + match[2], text)
    PAGE.write_text(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", type=lambda text: text.split(","), help="graphs, by name")
    parser.add_argument("--parts", type=lambda text: text.split(","), default=["process", "growth", "robust"])
    parser.add_argument("--no-measure", action="store_true", help="remake the tables from what was measured before")
    arguments = parser.parse_args()
    WORK.mkdir(parents=True, exist_ok=True)
    results = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    names = arguments.only or list(GRAPHS)
    for name in names if "process" in arguments.parts and not arguments.no_measure else []:
        whole_process(name, results)
        RESULTS.write_text(json.dumps(results, indent=1))
    for part, measure in (("growth", growth), ("robust", robust)):
        if part in arguments.parts and not arguments.no_measure:
            measure(results)
            RESULTS.write_text(json.dumps(results, indent=1))
    tables(results)


if __name__ == "__main__":
    main()

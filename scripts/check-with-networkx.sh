#!/bin/sh
# Compares posecut-pcm with networkx. On the consistency graphs that posecut-pcm writes, networkx must find no larger clique, and the
# edges that posecut-pcm keeps must be a clique of the reported size. Skipped if networkx cannot be installed.
# Usage: scripts/check-with-networkx.sh [DIRECTORY_OF_PROGRAMS]
set -eu
cd "$(dirname "$0")/.."
programs=${1:-target/release}
python=$(scripts/python-environment.sh networkx) || { echo 'skipped: networkx cannot be installed here'; exit 0; }
cargo build --release --locked --quiet --workspace --example draw
draw=${CARGO_TARGET_DIR:-target}/release/examples/draw
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for dimension in 2 3; do
  for falsehood in uniform grouped near-miss; do
    for outliers in 0.5 0.9; do
      "$draw" 100 $outliers $falsehood $dimension 1 > "$work/$falsehood-$outliers-${dimension}d.jsonl"
    done
  done
done
for graph in "$work"/*.jsonl; do
  name=${graph%.jsonl}
  "$programs/posecut-pcm" -q "$graph" -o "$name.pcm" --stats "$name.stats" --consistency-graph "$name.dimacs"
done
"$python" - "$work"/*.stats <<'PYTHON'
import json, pathlib, sys
import networkx

for path in map(pathlib.Path, sys.argv[1:]):
    stats = json.loads(path.read_text())
    graph, groups, landmark = networkx.Graph(), [], {}
    for line in path.with_suffix(".dimacs").read_text().splitlines():
        word = line.split()
        if word[:2] == ["c", "group"]:
            groups.append(range(int(word[2]), int(word[3]) + 1))
        elif word[:2] == ["c", "vertex"]:
            landmark[int(word[2])] = int(word[4])
            graph.add_node(int(word[2]))
        elif word[0] == "e":
            graph.add_edge(int(word[1]), int(word[2]))
    edges = [json.loads(line) for line in path.with_suffix(".pcm").read_text().splitlines()]
    edges = {edge["id"]: edge for edge in edges if edge["kind"] == "landmark"}
    kept = total = 0
    for group in groups:
        clique = [vertex for vertex in group if edges[landmark[vertex]].get("pcm_role") == "clique"]
        if any(not graph.has_edge(a, b) for place, a in enumerate(clique) for b in clique[place + 1:]):
            sys.exit(f"{path.stem}: what posecut-pcm keeps is no clique")
        if any(edges[landmark[vertex]]["pcm_degree"] != graph.degree(vertex) for vertex in group):
            sys.exit(f"{path.stem}: pcm_degree is not the degree in the graph")
        kept += len(clique)
        total += networkx.max_weight_clique(graph.subgraph(group), weight=None)[1]
    print(f"{path.stem}: posecut keeps {kept}, networkx finds {total}")
    if not (kept == total == stats["clique_size"] == stats["clique_upper_bound"]):
        sys.exit(f"{path.stem}: the sizes differ, or the stated {stats['clique_size']} and its bound do")
PYTHON

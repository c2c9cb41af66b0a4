#!/bin/sh
# Regenerates testdata/: a small simulated graph, and the expected output of the stages for it. Run it after an intended change of
# results, and read the difference before you commit it.
# Usage: scripts/make-testdata.sh [DIRECTORY_OF_PROGRAMS]
set -eu
cd "$(dirname "$0")/.."
programs=${1:-target/release}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$programs/posecut-simulate" -q --length 1800 --rate 5 --seed 8 -o "$work/2012-01-22"
"$programs/posecut-ingest" -q "$work/2012-01-22" --keep-every 15 --sigma-translation 0.3 --sigma-rotation 0.05 -o "$work/session.jsonl"
"$programs/posecut-construct" -q "$work/session.jsonl" --radius 5 --heading 45 --incorrect-rate 0.3 -o testdata/graph.jsonl

"$programs/posecut-oracle" -q testdata/graph.jsonl | "$programs/posecut-optimize" -q -o "$work/reference.jsonl"
for method in pcm multicut; do
  "$programs/posecut-$method" -q testdata/graph.jsonl -o "$work/$method.jsonl"
  "$programs/posecut-optimize" -q "$work/$method.jsonl" |
    "$programs/posecut-evaluate" -q --reference "$work/reference.jsonl" -o /dev/null --stats "$work/stats.json"
  grep -v '"seconds"' "$work/stats.json" > "testdata/$method.stats"
  # The ids of the edges that the method rejects, one per line.
  sed -n "s/^{\"kind\":\"landmark\",\"id\":\([0-9]*\),.*\"rejected_by\":\"$method\".*/\1/p" "$work/$method.jsonl" \
    > "testdata/$method.rejected"
done

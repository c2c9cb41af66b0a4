#!/bin/sh
# Runs the pandas recipe of docs/other-tools.md, and compares its counts with posecut-evaluate and its output with the page (--write
# puts the output there). Skipped if pandas cannot be installed.
# Usage: scripts/check-with-pandas.sh [--write] [DIRECTORY_OF_PROGRAMS]
set -eu
cd "$(dirname "$0")/.."
write=
[ "${1:-}" != --write ] || { write=yes; shift; }
programs=${1:-target/release}
document=docs/other-tools.md
python=$(scripts/python-environment.sh pandas) || { echo 'skipped: pandas cannot be installed here'; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
scripts/extract.sh "$document" recipe.py >"$work/recipe.py"
"$programs/posecut-pcm" -q testdata/graph.jsonl | "$programs/posecut-optimize" -q -o "$work/graph.jsonl"
"$programs/posecut-evaluate" -q "$work/graph.jsonl" -o "$work/result.json"
{ echo; echo '```'; "$python" "$work/recipe.py" "$work/graph.jsonl"; echo '```'; echo; } >"$work/shown"
cat "$work/shown"
"$python" - "$work" <<'PYTHON'
import json, sys

work = sys.argv[1]
edges = json.load(open(f"{work}/result.json"))["edges"]
names = {("True", "True"): "true_positive", ("False", "True"): "false_positive",
         ("True", "False"): "false_negative", ("False", "False"): "true_negative"}
rows = [line.split() for line in open(f"{work}/shown")]
counts = {(row[0], row[1]): int(row[2]) for row in rows if len(row) == 3 and row[0] in ("True", "False")}
for key, name in names.items():
    if counts.get(key, 0) != edges[name]:
        sys.exit(f"{name}: {edges[name]}, and the recipe counts {counts.get(key, 0)}")
PYTHON
cp "$document" "$work/document"
"$programs/xtask" splice "$work/document" recipe <"$work/shown"
if [ "$write" ]; then
  cp "$work/document" "$document"
elif ! diff -uw "$document" "$work/document"; then
  echo "$document shows another output; scripts/check-with-pandas.sh --write puts this one there"
  exit 1
fi

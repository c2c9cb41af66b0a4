#!/bin/sh
# Extracts the stages of docs/bring-your-own-stage.md, checks them against the contract, and runs them instead of PCM in
# `make table`. The Python stage needs python3, the shell stage needs jq. A stage whose interpreter is missing is skipped by name.
# Usage: scripts/check-own-stage.sh [DIRECTORY_OF_PROGRAMS]
set -eu
cd "$(dirname "$0")/.."
programs=${1:-target/release}
document=docs/bring-your-own-stage.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for stage in my-stage.py my-stage.sh; do
  scripts/extract.sh "$document" "$stage" >"$work/$stage"
  chmod +x "$work/$stage"
  case $stage in *.py) needed=python3 ;; *.sh) needed=jq ;; esac
  command -v "$needed" >/dev/null || { echo "skipped: no $needed: $stage"; continue; }
  echo "$stage: $(wc -l <"$work/$stage") lines"
  "$programs/posecut-conform" -o "$work/$stage.txt" -- "$work/$stage" || { cat "$work/$stage.txt"; exit 1; }
  tail -n 1 "$work/$stage.txt"
  make --silent table PCM="$work/$stage" PIPELINES=paper SESSIONS=2012-01-22 SEEDS=1 METHODS=pcm \
    RESULTS="$work/results" SIMULATED=target/ci/simulated >"$work/table.txt" || { cat "$work/table.txt"; exit 1; }
  grep -E '^\| *(method|pcm \(pcm = .*\)) ' "$work/table.txt" | head -n 2 | tee "$work/rows.txt"
  # The table needs a header and a row with a number that names the stage, and the optimised graph needs the stage's own mark.
  grep -qE '^\| *pcm \(pcm = .*\) +\| +[0-9]' "$work/rows.txt" || { echo "the table has no row for $stage"; exit 1; }
  mark=${stage%.py}
  grep -rqF "\"rejected_by\":\"$mark\"" "$work/results" || { echo "$stage rejected nothing, or did not run"; exit 1; }
done

#!/bin/sh
# Sweeps pipelines/regimes.toml over real sessions and, with "simulated" as second word, over simulated ones too, and remakes
# the tables of docs/regimes.md. Resumes where it was broken off.
# Usage: scripts/regimes.sh NCLT_DIRECTORY [simulated]
set -eu
cd "$(dirname "$0")/.."
nclt=${1:?name the directory of NCLT sessions, such as data/nclt}
shift
results=results/regimes/results.jsonl
# Points that cannot be drawn (a session with too few landmark edges) are named, and left out.
make --silent regimes NCLT="$nclt" || echo "some runs failed: their points are left out"
if [ "${1:-}" = simulated ]; then
  shift
  make --silent regimes || echo "some runs failed: their points are left out"
  results="$results results/regimes-simulated/results.jsonl"
fi
# Names without spaces.
# shellcheck disable=SC2086
"${CARGO_TARGET_DIR:-target}/release/posecut-report" regimes $results --methods none,pcm,pcm-root,pcm-calibrated,gc,pcm+gc --document docs/regimes.md

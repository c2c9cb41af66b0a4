#!/bin/sh
# Sweeps pipelines/regimes.toml over real and simulated sessions, and remakes the tables of docs/results/regimes.md. It resumes where it
# stopped; from nothing, it takes about an hour on two cores.
# Usage: scripts/regimes.sh NCLT_DIRECTORY
set -eu
cd "$(dirname "$0")/.."
nclt=${1:?name the directory of NCLT sessions, such as data/nclt}
# A failed run is named, and its point is omitted.
make --silent regimes NCLT="$nclt" || echo "some runs failed: their points are left out"
make --silent regimes || echo "some runs failed: their points are left out"
"${CARGO_TARGET_DIR:-target}/release/posecut-report" regimes results/regimes/results.jsonl results/regimes-simulated/results.jsonl \
  --methods none,pcm,pcm-root,pcm-calibrated,gc,pcm+gc,pcm-calibrated+gc --document docs/results/regimes.md

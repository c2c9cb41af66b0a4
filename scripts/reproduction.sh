#!/bin/sh
# Remakes every table of docs/results/reproduction.md: runs the experiments and splices their tables between the markers
#   <!-- begin: NAME --> and <!-- end: NAME -->.
# Usage: scripts/reproduction.sh NCLT_DIRECTORY
set -eu
cd "$(dirname "$0")/.."
nclt=${1:?name the directory of NCLT sessions, such as data/nclt}
sessions='2012-01-08 2012-01-22 2012-08-04 2012-11-16 2013-02-23'
document=docs/results/reproduction.md
chance='none pcm pcm-chance pcm+gc pcm-chance+gc'

real() { # NAME, then variables of make
  name=$1
  shift
  make --silent -j2 table NCLT="$nclt" SESSIONS="$sessions" SEEDS=5 RESULTS="results/reproduction/$name" "$@" >/dev/null
  splice "$name" "results/reproduction/$name/table.md"
}

splice() { # NAME FILE
  awk -v name="$1" -v file="$2" '
    $0 == "<!-- begin: " name " -->" { print; print ""; while ((getline line < file) > 0) print line; skip = 1; next }
    $0 == "<!-- end: " name " -->" { skip = 0 }
    !skip { print }
  ' "$document" > "$document.new"
  mv "$document.new" "$document"
}

make --silent -j2 table SEEDS=5 RESULTS=results/reproduction/simulated >/dev/null
splice simulated results/reproduction/simulated/table-simulated.md
real real
# The paper's solver, and what it changes.
real isam2 OPTIMIZE="${CARGO_TARGET_DIR:-target}/release/posecut-isam"
scripts/reproduction-tables.py difference results/reproduction/real/table.csv results/reproduction/isam2/table.csv \
  > results/reproduction/difference.md
splice isam2-difference results/reproduction/difference.md
# The pseudo ground truth after PCM.
real after-pcm PIPELINES='paper-after-pcm calibrated-after-pcm'
# shellcheck disable=SC2086 # a list of sessions
scripts/reproduction-tables.py nees "${CARGO_TARGET_DIR:-target}/release/posecut-ingest" "$nclt" $sessions \
  > results/reproduction/nees.md
splice nees results/reproduction/nees.md
make --silent -j2 table SEEDS=5 METHODS="$chance" RESULTS=results/reproduction/chance-simulated >/dev/null
splice chance-simulated results/reproduction/chance-simulated/table-simulated.md
real chance METHODS="$chance"
# 2012-11-16 is not in this table: only edges across the cut join its halves.
real seam SESSIONS='2012-01-08 2012-01-22 2012-08-04 2013-02-23' METHODS='pcm pcm+gc' \
  'paper.construct=--split middle --minimum-interval 60' 'calibrated.construct=--split middle --minimum-interval 60'
real root PIPELINES=calibrated METHODS='none pcm gc pcm+gc' 'calibrated.pcm=--test root --probability 0.99'
real space METHODS='pcm pcm+gc' \
  'paper.ingest=--dimension 3 --sigma-translation 0.3 --sigma-rotation 0.05' \
  'calibrated.ingest=--dimension 3 --sigma-translation 0.1 --sigma-rotation 0.02' \
  'paper.evaluate=--align se3' 'calibrated.evaluate=--align se3'

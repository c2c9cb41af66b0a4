#!/bin/sh
# Compares posecut-optimize with gtsam. On the same graph, gtsam must find the same cost, no lower cost from posecut's optimum, and the
# same covariances of relative poses, also for rejected landmark edges.
# Skipped if gtsam cannot be installed.
# Usage: scripts/check-with-gtsam.sh [DIRECTORY_OF_PROGRAMS]
set -eu
cd "$(dirname "$0")/.."
programs=${1:-target/release}
python=$(scripts/python-environment.sh gtsam) || { echo 'skipped: gtsam cannot be installed here'; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# In space: the same drive, lifted, because the test graph is planar.
python3 scripts/gtsam/lift.py testdata/graph.jsonl "$work/space.jsonl"
cp testdata/graph.jsonl "$work/plane.jsonl"
for name in plane space; do
  "$programs/posecut-convert" -q "$work/$name.jsonl" -o "$work/$name.g2o"
done
"$python" scripts/gtsam/files.py "$work"

"$programs/posecut-oracle" -q testdata/graph.jsonl | "$programs/posecut-optimize" -q --marginals landmark -o "$work/ours.jsonl" --stats "$work/stats.json"
"$programs/posecut-convert" -q "$work/ours.jsonl" -o "$work/ours.g2o"
"$python" scripts/gtsam/optimum.py "$work"

# Poses: gtsam starts from the chordal relaxation and must end at posecut's poses, within 1e-6 m. In the plane, gtsam's arithmetic is
# less precise than that; planar_optimum.py continues from gtsam's result in extended precision, and its result counts. gtsam's own
# factor between two poses omits the derivative of the logarithm from its Jacobians; this script gives it complete ones.
"$python" -c "import scipy" 2>/dev/null || "$python" -m pip install --quiet scipy
for name in drive smallGrid3D CSAIL MIT M3500; do
  if [ "$name" = drive ]; then
    "$programs/posecut-oracle" -q testdata/graph.jsonl -o "$work/$name.jsonl"
  elif [ -f "${POSECUT_SHARED_DATA:-../shared/data}/g2o/$name.g2o" ]; then
    "$programs/posecut-convert" -q "${POSECUT_SHARED_DATA:-../shared/data}/g2o/$name.g2o" -o "$work/$name.jsonl"
  else
    echo "skipped: no data: $name"
    continue
  fi
  "$programs/posecut-optimize" -q --cost-tolerance 0 "$work/$name.jsonl" -o "$work/$name.ours.jsonl" --stats "$work/$name.stats.json"
  "$programs/posecut-optimize" -q --initialisation chordal --max-iterations 0 "$work/$name.jsonl" -o "$work/$name.start.jsonl"
  "$programs/posecut-convert" -q "$work/$name.ours.jsonl" -o "$work/$name.ours.g2o"
  "$programs/posecut-convert" -q "$work/$name.start.jsonl" -o "$work/$name.start.g2o"
done
"$python" scripts/gtsam/poses.py "$work"

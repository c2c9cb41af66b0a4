#!/bin/sh
# Holds posecut-evaluate to evo, the field's usual tool for trajectory errors: the same two trajectories, aligned by
# SE(3), must have the same absolute trajectory error to 1e-9 m. Skipped where evo cannot be installed.
# Usage: scripts/check-with-evo.sh [DIRECTORY_OF_PROGRAMS]
set -eu
cd "$(dirname "$0")/.."
programs=${1:-target/release}
environment=target/evo
if ! "$environment/bin/python" -c 'import evo' 2>/dev/null; then
  if ! { python3 -m venv "$environment" && "$environment/bin/pip" install --quiet evo; } >/dev/null 2>&1; then
    echo 'skipped: evo cannot be installed here'
    exit 0
  fi
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$programs/posecut-oracle" -q testdata/graph.jsonl | "$programs/posecut-optimize" -q -o "$work/reference.jsonl"
"$programs/posecut-pcm" -q testdata/graph.jsonl | "$programs/posecut-optimize" -q -o "$work/estimate.jsonl"
for name in reference estimate; do
  "$programs/posecut-convert" -q "$work/$name.jsonl" -o "$work/$name.tum"
done
"$programs/posecut-evaluate" -q "$work/estimate.jsonl" --reference "$work/reference.jsonl" --align se3 -o "$work/result.json"
"$environment/bin/python" - "$work" <<'PYTHON'
import json, sys
from evo.core import metrics, sync
from evo.tools import file_interface

work = sys.argv[1]
reference = file_interface.read_tum_trajectory_file(f"{work}/reference.tum")
estimate = file_interface.read_tum_trajectory_file(f"{work}/estimate.tum")
reference, estimate = sync.associate_trajectories(reference, estimate)
estimate.align(reference)
ape = metrics.APE(metrics.PoseRelation.translation_part)
ape.process_data((reference, estimate))
ours = json.load(open(f"{work}/result.json"))["ate"]["translation_m"]
worst = 0.0
for name, theirs in ape.get_all_statistics().items():
    distance = abs(theirs - ours[name])
    # Sums of squares are larger than the errors by the number of poses.
    worst = max(worst, distance / max(1.0, abs(theirs)))
    print(f"{name}: evo {theirs!r}, posecut {ours[name]!r}, distance {distance:.1e}")
sys.exit(0 if worst <= 1e-9 else f"posecut and evo disagree by {worst:.1e}")
PYTHON

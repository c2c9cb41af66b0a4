#!/bin/sh
# Compares posecut-evaluate with evo, the field's usual tool for trajectory errors. The same two trajectories, aligned by SE(3), must
# have the same absolute trajectory error to 1e-9 m, from TUM files and from KITTI files. evo must read the result file of
# posecut-convert and find the same figures in it. Skipped if evo cannot be installed.
# Usage: scripts/check-with-evo.sh [DIRECTORY_OF_PROGRAMS]
set -eu
cd "$(dirname "$0")/.."
programs=${1:-target/release}
python=$(scripts/python-environment.sh evo) || { echo 'skipped: evo cannot be installed here'; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$programs/posecut-oracle" -q testdata/graph.jsonl | "$programs/posecut-optimize" -q -o "$work/reference.jsonl"
"$programs/posecut-pcm" -q testdata/graph.jsonl | "$programs/posecut-optimize" -q -o "$work/estimate.jsonl"
for name in reference estimate; do
  "$programs/posecut-convert" -q "$work/$name.jsonl" -o "$work/$name.tum"
  "$programs/posecut-convert" -q "$work/$name.jsonl" -o "$work/$name.kitti"
done
"$programs/posecut-convert" -q "$work/estimate.jsonl" --reference "$work/reference.jsonl" --align se3 -o "$work/result.zip"
"$programs/posecut-evaluate" -q "$work/estimate.jsonl" --reference "$work/reference.jsonl" --align se3 -o "$work/result.json"
"$python" - "$work" <<'PYTHON'
import json, sys
import numpy
from evo.core import metrics, sync
from evo.tools import file_interface

work = sys.argv[1]
ours = json.load(open(f"{work}/result.json"))["ate"]["translation_m"]


def error_of(reference, estimate):
    """evo_ape --align"""
    estimate.align(reference)
    ape = metrics.APE(metrics.PoseRelation.translation_part)
    ape.process_data((reference, estimate))
    return ape


def compare(what, theirs):
    worst = 0.0
    for name, value in theirs.items():
        distance = abs(value - ours[name])
        # Sums of squares grow with the number of poses, so their tolerance does too.
        worst = max(worst, distance / max(1.0, abs(value)))
        print(f"{what}: {name}: evo {value!r}, posecut {ours[name]!r}, distance {distance:.1e}")
    if not worst <= 1e-9:
        sys.exit(f"{what}: posecut and evo disagree by {worst:.1e}")


tum = [file_interface.read_tum_trajectory_file(f"{work}/{name}.tum") for name in ("reference", "estimate")]
tum = error_of(*sync.associate_trajectories(*tum))
compare("tum", tum.get_all_statistics())
kitti = [file_interface.read_kitti_poses_file(f"{work}/{name}.kitti") for name in ("reference", "estimate")]
compare("kitti", error_of(*kitti).get_all_statistics())

result = file_interface.load_res_file(f"{work}/result.zip", load_trajectories=True)
compare("zip", result.stats)
errors = result.np_arrays["error_array"]
if numpy.abs(errors - tum.error).max() > 1e-9:
    sys.exit("zip: the errors are not those that evo finds pose by pose")
reference, estimate = result.trajectories["reference"], result.trajectories["estimate"]
again = metrics.APE(metrics.PoseRelation.translation_part)
again.process_data((reference, estimate))
compare("zip, its trajectories as they stand", again.get_all_statistics())
if list(result.np_arrays["timestamps"]) != list(reference.timestamps):
    sys.exit("zip: the times are not those of its trajectories")
PYTHON
"${python%python}evo_res" "$work/result.zip" >"$work/evo_res.txt" || { cat "$work/evo_res.txt"; exit 1; }
echo "evo_res reads the result file"

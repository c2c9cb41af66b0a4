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
python3 - testdata/graph.jsonl "$work/space.jsonl" <<'PYTHON'
import json, math, sys

def lifted(pose, height, roll):
    x, y, yaw = pose
    c, s, cr, sr = math.cos(yaw / 2), math.sin(yaw / 2), math.cos(roll / 2), math.sin(roll / 2)
    return [x, y, height, c * sr, s * sr, s * cr, c * cr]

with open(sys.argv[1]) as lines, open(sys.argv[2], "w") as out:
    for number, line in enumerate(lines):
        record = json.loads(line)
        record.pop("truth", None)
        if record["kind"] == "header":
            record["dimension"] = 3
            record.pop("noise_models", None)
        if "pose" in record:
            record["pose"] = lifted(record["pose"], 0.01 * number, 0.2 * math.sin(number))
        if "measurement" in record:
            record["measurement"] = lifted(record["measurement"], 0.02 * math.cos(number), 0.1 * math.sin(number))
            record.pop("noise", None)
            terms = ([100 + row if row == column else 1.5 for column in range(row, 6)] for row in range(6))
            record["information"] = [term for row in terms for term in row]
        out.write(json.dumps(record) + "\n")
PYTHON
cp testdata/graph.jsonl "$work/plane.jsonl"
for name in plane space; do
  "$programs/posecut-convert" -q "$work/$name.jsonl" -o "$work/$name.g2o"
done
"$python" - "$work" <<'PYTHON'
import json, sys
import gtsam
import numpy

work = sys.argv[1]


def close(ours, theirs, what, tolerance=1e-12):
    ours, theirs = numpy.asarray(ours), numpy.asarray(theirs)
    distance = numpy.abs(ours - theirs).max() / max(1.0, numpy.abs(ours).max())
    if not distance <= tolerance:
        sys.exit(f"{what}: {ours} in the file, {theirs} in gtsam")
    return distance


for name, spatial in (("plane", False), ("space", True)):
    lines = [json.loads(line) for line in open(f"{work}/{name}.jsonl")]
    models = lines[0].get("noise_models", {})
    nodes = [line for line in lines if line["kind"] == "node"]
    edges = [line for line in lines if line["kind"] in ("odometry", "landmark") and "measurement" in line]
    graph, values = gtsam.readG2o(f"{work}/{name}.g2o", spatial)
    if values.size() != len(nodes) or graph.size() != len(edges):
        sys.exit(f"{name}: {len(nodes)} nodes and {len(edges)} edges; gtsam has {values.size()} and {graph.size()}")

    def matrix(pose):
        """The pose as gtsam holds it, as a matrix: quaternions of either sign are one rotation."""
        if spatial:
            x, y, z, qx, qy, qz, qw = pose
            return gtsam.Pose3(gtsam.Rot3.Quaternion(qw, qx, qy, qz), [x, y, z]).matrix()
        return gtsam.Pose2(*pose).matrix()

    worst = 0.0
    for node in nodes:
        theirs = values.atPose3(node["id"]) if spatial else values.atPose2(node["id"])
        worst = max(worst, close(matrix(node["pose"]), theirs.matrix(), f"{name}: node {node['id']}"))
    for place, edge in enumerate(edges):
        factor = graph.at(place)
        if list(factor.keys()) != [edge["from"], edge["to"]]:
            sys.exit(f"{name}: edge {edge['id']} joins {factor.keys()} in gtsam")
        worst = max(worst, close(matrix(edge["measurement"]), factor.measured().matrix(), f"{name}: edge {edge['id']}"))
        size = 6 if spatial else 3
        terms = iter(edge["information"] if "information" in edge else models[edge["noise"]]["information"])
        information = numpy.zeros((size, size))
        for row in range(size):
            for column in range(row, size):
                information[row, column] = information[column, row] = next(terms)
        # gtsam puts rotation before translation in space; in the plane the order is the same.
        order = [3, 4, 5, 0, 1, 2] if spatial else [0, 1, 2]
        theirs = factor.noiseModel().information()
        worst = max(worst, close(information[numpy.ix_(order, order)], theirs, f"{name}: information of {edge['id']}", 1e-9))
    print(f"{name}: gtsam reads {len(nodes)} nodes and {len(edges)} edges as they are; largest difference {worst:.1e}")
PYTHON

"$programs/posecut-oracle" -q testdata/graph.jsonl | "$programs/posecut-optimize" -q --marginals landmark -o "$work/ours.jsonl" --stats "$work/stats.json"
"$programs/posecut-convert" -q "$work/ours.jsonl" -o "$work/ours.g2o"
"$python" - "$work" <<'PYTHON'
import json, sys
import gtsam

work = sys.argv[1]
graph, ours = gtsam.readG2o(f"{work}/ours.g2o", False)
first = ours.keys()[0]
graph.add(gtsam.PriorFactorPose2(first, ours.atPose2(first), gtsam.noiseModel.Isotropic.Sigma(3, 1e-3)))
chi_square = json.load(open(f"{work}/stats.json"))["chi_square"]
theirs = 2.0 * graph.error(ours)  # gtsam's error is half the sum of squares
parameters = gtsam.LevenbergMarquardtParams()
parameters.setRelativeErrorTol(1e-14)
parameters.setAbsoluteErrorTol(1e-14)
best = gtsam.LevenbergMarquardtOptimizer(graph, ours, parameters).optimize()
improved = 2.0 * graph.error(best)
moved = max((ours.atPose2(key).translation() - best.atPose2(key).translation()).__abs__().max() for key in ours.keys())
print(f"chi_square: posecut {chi_square!r}, gtsam at our poses {theirs!r}, gtsam optimised from there {improved!r}; poses moved {moved:.1e} m")
if abs(theirs - chi_square) > 1e-9 * chi_square:
    sys.exit("posecut and gtsam disagree on the cost of the same poses")
if chi_square - improved > 1e-8 * chi_square or moved > 1e-3:
    sys.exit("gtsam found a better optimum")

import numpy as np

# Relative poses do not depend on gtsam's prior on the first pose.
marginals = gtsam.Marginals(graph, ours)
edges = [json.loads(line) for line in open(f"{work}/ours.jsonl")]
edges = [edge for edge in edges if edge["kind"] == "landmark" and edge.get("predicted_covariance")]
worst, rejected = 0.0, 0
for edge in edges:
    i, j = edge["from"], edge["to"]
    joint = marginals.jointMarginalCovariance(gtsam.KeyVector([i, j]))
    adjoint = ours.atPose2(i).between(ours.atPose2(j)).inverse().AdjointMap()
    jacobian = np.hstack([-adjoint, np.eye(3)])
    blocks = np.block([[joint.at(a, b) for b in (i, j)] for a in (i, j)])
    expected = jacobian @ blocks @ jacobian.T
    found = np.zeros((3, 3))
    found[np.triu_indices(3)] = edge["predicted_covariance"]
    found = found + found.T - np.diag(np.diag(found))
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    worst = max(worst, (abs(found - expected) / scale).max())
    rejected += "rejected_by" in edge
print(f"covariances of {len(edges)} relative poses, {rejected} of them of rejected edges, within {worst:.1e} of gtsam's")
if not edges or not rejected or worst > 1e-3:
    sys.exit("posecut and gtsam disagree on covariances")
PYTHON

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
"$python" - "$work" <<'PYTHON'
import json, pathlib, sys
import gtsam
import numpy as np

sys.path.insert(0, "scripts")
import planar_optimum


def whole(factor, pose, group):
    """The factor with the derivative of the logarithm in its Jacobians."""
    i, j = factor.keys()
    inverse = factor.measured().inverse()

    def error(_, values, jacobians):
        relative = pose(values, i).between(pose(values, j))
        mismatch = inverse.compose(relative)
        if jacobians is not None:
            jacobians[1] = group.LogmapDerivative(group.Logmap(mismatch))
            jacobians[0] = -jacobians[1] @ relative.inverse().AdjointMap()
        return group.Logmap(mismatch)

    return gtsam.CustomFactor(factor.noiseModel(), [i, j], error)


work = pathlib.Path(sys.argv[1])
for name in ("drive", "smallGrid3D", "CSAIL", "MIT", "M3500"):
    if not (work / f"{name}.start.g2o").exists():
        continue
    spatial = "EDGE_SE3" in (work / f"{name}.start.g2o").read_text()
    graph, start = gtsam.readG2o(str(work / f"{name}.start.g2o"), spatial)
    _, ours = gtsam.readG2o(str(work / f"{name}.ours.g2o"), spatial)
    pose = (lambda values, key: values.atPose3(key)) if spatial else (lambda values, key: values.atPose2(key))
    group = gtsam.Pose3 if spatial else gtsam.Pose2
    factors, graph = graph, gtsam.NonlinearFactorGraph()
    for place in range(factors.size()):
        graph.add(whole(factors.at(place), pose, group))
    first = min(ours.keys())
    prior = gtsam.PriorFactorPose3 if spatial else gtsam.PriorFactorPose2
    graph.add(prior(first, pose(ours, first), gtsam.noiseModel.Isotropic.Sigma(6 if spatial else 3, 1e-3)))
    theirs, steps = start, []
    for _ in range(40):  # linear convergence where measurements contradict each other
        delta = graph.linearize(theirs).optimize()
        steps.append(max(np.abs(delta.at(key)).max() for key in theirs.keys()))
        theirs = theirs.retract(delta)
    # Both fix the first pose, so no alignment is needed.
    far = max(np.linalg.norm(np.subtract(pose(ours, key).translation(), pose(theirs, key).translation())) for key in ours.keys())
    cost, other = 2.0 * graph.error(ours), 2.0 * graph.error(theirs)
    left = json.loads((work / f"{name}.stats.json").read_text())["last_step"]
    print(f"{name}: poses within {far:.1e} m of gtsam's, whose last steps are up to {max(steps[-5:]):.0e} and ours {left:.0e}; "
          f"its cost is {other - cost:.1e} above {cost:.10g}")
    # In space, gtsam's steps shrink to rounding errors. In the plane, weakly determined poses keep moving around the optimum.
    if abs(other - cost) > 1e-9 * cost or far > (1e-6 if spatial else 1e-3):
        sys.exit(f"{name}: gtsam ends elsewhere")
    if spatial:
        continue
    _, ends, measured, information = planar_optimum.read(work / f"{name}.start.g2o")
    components = lambda values: np.array([[pose(values, key).x(), pose(values, key).y(), pose(values, key).theta()] for key in sorted(ours.keys())])
    exact, lowest, last = planar_optimum.optimum(components(theirs), ends, measured, information)
    off = lambda values: float(np.linalg.norm((components(values) - exact)[:, :2].astype(float), axis=1).max())
    print(f"{name}: in extended precision, from gtsam's poses, last step {last:.0e}: posecut is {off(ours):.1e} m from the optimum, gtsam "
          f"{off(theirs):.1e} m; cost {float(lowest):.13g}")
    if last > 1e-11 or off(ours) > 1e-6:
        sys.exit(f"{name}: posecut is not at the optimum")
PYTHON

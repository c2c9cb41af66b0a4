"""Whether gtsam finds the cost that posecut found, no lower one from there, and the same covariances of relative poses.

Usage: optimum.py FOLDER (with ours.g2o, ours.jsonl and stats.json)
"""

import json
import sys

import gtsam
import numpy as np

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
print(
    f"chi_square: posecut {chi_square!r}, gtsam at our poses {theirs!r}, "
    f"gtsam optimised from there {improved!r}; poses moved {moved:.1e} m"
)
if abs(theirs - chi_square) > 1e-9 * chi_square:
    sys.exit("posecut and gtsam disagree on the cost of the same poses")
if chi_square - improved > 1e-8 * chi_square or moved > 1e-3:
    sys.exit("gtsam found a better optimum")

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

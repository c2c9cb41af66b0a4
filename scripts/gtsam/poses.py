"""Whether gtsam, from the chordal relaxation, ends at posecut's poses. In the plane a solution in extended precision judges.

Usage: poses.py FOLDER (with NAME.start.g2o, NAME.ours.g2o and NAME.stats.json)
"""

import json
import pathlib
import sys

import gtsam
import numpy as np
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


def pose3(values, key):
    return values.atPose3(key)


def pose2(values, key):
    return values.atPose2(key)


def solved(graph, start):
    """gtsam's solution by forty steps, with the length of each: convergence is linear where measurements contradict each other."""
    values, steps = start, []
    for _ in range(40):
        delta = graph.linearize(values).optimize()
        steps.append(max(np.abs(delta.at(key)).max() for key in values.keys()))
        values = values.retract(delta)
    return values, steps


def with_whole_factors(factors, first, pose, group, prior, size):
    graph = gtsam.NonlinearFactorGraph()
    for place in range(factors.size()):
        graph.add(whole(factors.at(place), pose, group))
    graph.add(prior(*first, gtsam.noiseModel.Isotropic.Sigma(size, 1e-3)))
    return graph


def components(values):
    """x, y and heading of all poses of the plane, in the order of their keys."""
    poses = [values.atPose2(key) for key in sorted(values.keys())]
    return np.array([[pose.x(), pose.y(), pose.theta()] for pose in poses])


def distance(values, exact):
    """The largest distance of a pose of the plane from its exact position."""
    return float(np.linalg.norm((components(values) - exact)[:, :2].astype(float), axis=1).max())


def compare(work, name):
    source = work / f"{name}.start.g2o"
    spatial = "EDGE_SE3" in source.read_text()
    factors, start = gtsam.readG2o(str(source), spatial)
    _, ours = gtsam.readG2o(str(work / f"{name}.ours.g2o"), spatial)
    pose, group, prior, size = (
        (pose3, gtsam.Pose3, gtsam.PriorFactorPose3, 6) if spatial else (pose2, gtsam.Pose2, gtsam.PriorFactorPose2, 3))
    first = min(ours.keys())
    graph = with_whole_factors(factors, (first, pose(ours, first)), pose, group, prior, size)
    theirs, steps = solved(graph, start)
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
        return
    _, ends, measured, information = planar_optimum.read(source)
    exact, lowest, last = planar_optimum.optimum(components(theirs), ends, measured, information)
    off = distance(ours, exact)
    print(f"{name}: in extended precision, from gtsam's poses, last step {last:.0e}: posecut is {off:.1e} m from the optimum, gtsam "
          f"{distance(theirs, exact):.1e} m; cost {float(lowest):.13g}")
    if last > 1e-11 or off > 1e-6:
        sys.exit(f"{name}: posecut is not at the optimum")


folder = pathlib.Path(sys.argv[1])
for graph_name in ("drive", "smallGrid3D", "CSAIL", "MIT", "M3500"):
    if (folder / f"{graph_name}.start.g2o").exists():
        compare(folder, graph_name)

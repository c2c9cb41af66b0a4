#!/usr/bin/env python3
"""Times gtsam's ISAM2 on a g2o graph, pose by pose, for `cargo xtask measure incremental`: prints one JSON object.

Usage: peer-isam2.py FILE.g2o 2|3 SKIP        (needs: pip install gtsam)

2 or 3 is the dimension, SKIP the number of steps between two relinearisations. A step ends with the estimate of the newest
pose. The total is the time inside of update and estimate; the quantiles include the construction of the factors. The prior on
the first pose takes no part in the cost.
"""

import importlib.metadata
import json
import sys
import time

import gtsam


def arrivals_of(graph):
    """The factors that end at each pose, odometry first."""
    arrivals = {}
    for index in range(graph.size()):
        factor = graph.at(index)
        keys = factor.keys()
        arrivals.setdefault(max(keys), []).append((min(keys) + 1 != max(keys), index, keys[0], keys[1], factor))
    return arrivals


def quantiles(seconds):
    ordered = sorted(seconds)
    return [1e3 * ordered[round((len(ordered) - 1) * share)] for share in (0.5, 0.95, 0.99, 1.0)]


def solver(skip):
    parameters = gtsam.ISAM2Params()
    parameters.setRelinearizeThreshold(0.1)
    parameters.relinearizeSkip = skip
    parameters.setOptimizationParams(gtsam.ISAM2GaussNewtonParams(0.001))
    return gtsam.ISAM2(parameters)


def run(path, spatial, skip):
    graph, _ = gtsam.readG2o(path, spatial)
    arrivals = arrivals_of(graph)
    isam = solver(skip)
    if spatial:
        identity, dimension = gtsam.Pose3(), 6
        estimate_of, prior = isam.calculateEstimatePose3, gtsam.PriorFactorPose3
    else:
        identity, dimension = gtsam.Pose2(), 3
        estimate_of, prior = isam.calculateEstimatePose2, gtsam.PriorFactorPose2
    steps, inside = [], 0.0
    for key in range(max(arrivals) + 1):
        start = time.perf_counter()
        factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        if key == 0:
            factors.add(prior(0, identity, gtsam.noiseModel.Isotropic.Sigma(dimension, 1e-6)))
            values.insert(0, identity)
        for position, (_, _, first, second, factor) in enumerate(sorted(arrivals.get(key, []), key=lambda a: a[:2])):
            factors.push_back(factor)
            if position == 0:
                measured = factor.measured()
                guess = estimate_of(second if first == key else first)
                values.insert(key, guess.compose(measured if second == key else measured.inverse()))
        update = time.perf_counter()
        isam.update(factors, values)
        estimate_of(key)
        end = time.perf_counter()
        inside += end - update
        steps.append(end - start)
    cost = 2.0 * graph.error(isam.calculateEstimate())
    return {"total_s": inside, "quantiles_ms": quantiles(steps), "cost": cost,
            "version": importlib.metadata.version("gtsam")}


if __name__ == "__main__":
    _, file, space, every = sys.argv
    print(json.dumps(run(file, space == "3", int(every))))

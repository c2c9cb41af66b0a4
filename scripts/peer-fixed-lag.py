#!/usr/bin/env python3
"""Times gtsam's fixed-lag smoothers on a planar g2o graph, pose by pose, for `cargo xtask measure lag`: prints one JSON object.

Usage: peer-fixed-lag.py FILE.g2o incremental|batch LAG SECONDS        (needs: pip install gtsam)

LAG is in poses. The run ends after so many seconds, and `steps` says how far it came; an exception ends it too, and `error` has its
first line. The quantiles leave out the steps in which the window fills. The vertices of the file are the batch optimum; `live_m` is
the root mean squared distance of the window's positions from it, after the last step: it is comparable at the end of the file only.
"""

import importlib.metadata
import json
import math
import resource
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


def smoother_of(kind, lag):
    if kind == "batch":
        return gtsam.BatchFixedLagSmoother(float(lag))
    parameters = gtsam.ISAM2Params()
    parameters.setRelinearizeThreshold(0.1)
    parameters.relinearizeSkip = 10
    parameters.findUnusedFactorSlots = True
    parameters.setOptimizationParams(gtsam.ISAM2GaussNewtonParams(0.001))
    return gtsam.IncrementalFixedLagSmoother(float(lag), parameters)


def step(smoother, key, factors_here, previous):
    """Adds a pose and returns its estimate."""
    factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    if key == 0:
        factors.add(gtsam.PriorFactorPose2(0, gtsam.Pose2(), gtsam.noiseModel.Isotropic.Sigma(3, 1e-6)))
        values.insert(0, gtsam.Pose2())
    for place, (_, _, first, _, factor) in enumerate(sorted(factors_here, key=lambda a: a[:2])):
        factors.push_back(factor)
        if place == 0:
            measured = factor.measured()
            values.insert(key, previous.compose(measured if first != key else measured.inverse()))
    begin = time.perf_counter()
    smoother.update(factors, values, {key: float(key)})
    estimate = smoother.calculateEstimatePose2(key)
    return estimate, time.perf_counter() - begin


def distance(smoother, batch):
    """Root mean squared distance of the window from the batch optimum."""
    values = smoother.calculateEstimate()
    squares = [(values.atPose2(key).x() - batch.atPose2(key).x()) ** 2 + (values.atPose2(key).y() - batch.atPose2(key).y()) ** 2
               for key in values.keys()]
    return math.sqrt(sum(squares) / len(squares))


def run(path, kind, lag, limit):
    graph, batch = gtsam.readG2o(path, False)
    arrivals = arrivals_of(graph)
    smoother, estimate, seconds, error = smoother_of(kind, lag), gtsam.Pose2(), [], None
    start = time.process_time()
    poses = max(arrivals) + 1
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for key in range(poses):
        try:
            estimate, inside = step(smoother, key, arrivals.get(key, []), estimate)
        except (RuntimeError, IndexError, ValueError) as problem:
            error = (str(problem).strip().splitlines() or [""])[0]
            break
        seconds.append(inside)
        if time.process_time() - start > limit:
            break
    settled = sorted(seconds[min(lag, len(seconds) // 2):])
    quantiles = [1e3 * settled[round((len(settled) - 1) * share)] for share in (0.5, 0.99, 1.0)]
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1e3
    live = None if error else distance(smoother, batch)
    return {"steps": len(seconds), "poses": poses, "total_s": sum(seconds), "quantiles_ms": quantiles, "megabytes": grown,
            "live_m": live if len(seconds) == poses else None, "error": error, "version": importlib.metadata.version("gtsam")}


if __name__ == "__main__":
    _, file, smoother_kind, lag_in_poses, most_seconds = sys.argv
    print(json.dumps(run(file, smoother_kind, int(lag_in_poses), float(most_seconds))))

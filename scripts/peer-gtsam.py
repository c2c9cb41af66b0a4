#!/usr/bin/env python3
"""Optimises a g2o graph by gtsam's Gauss-Newton, for `cargo xtask measure optimize`: prints one JSON object.

Usage: peer-gtsam.py SOURCE.g2o TARGET.g2o REPEATS        (needs: pip install gtsam)

Runs gtsam's default linear solver and, where the wheel has it, MULTIFRONTAL_SOLVER; reports the faster one that ends, by its best time of
the repeats, or of as many as take 3 s. `iterations` is null where the system is indeterminate.
"""

import json
import math
import sys
import time
from pathlib import Path

import gtsam


def main(source, target, repeats):
    spatial = "EDGE_SE3" in Path(source).read_text()
    graph, start = gtsam.readG2o(source, spatial)
    noise = gtsam.noiseModel.Isotropic.Sigma(6 if spatial else 3, 1e-3)
    first = min(start.keys())
    if spatial:
        graph.add(gtsam.PriorFactorPose3(first, start.atPose3(first), noise))
    else:
        graph.add(gtsam.PriorFactorPose2(first, start.atPose2(first), noise))
    runs = [timed(graph, start, solver, int(repeats)) for solver in solvers()]
    # Indeterminate runs count only where there is no other.
    seconds, iterations, result, solver = min(runs, key=lambda run: (run[1] is None, run[0]))
    gtsam.writeG2o(graph, result, target)
    print(json.dumps({"seconds": seconds, "iterations": iterations, "solver": solver}))


def solvers():
    """The default linear solver, and MULTIFRONTAL_SOLVER where the wheel has it (gtsam 4.3)."""
    names = [gtsam.GaussNewtonParams().getLinearSolverType()]
    if hasattr(gtsam.NonlinearOptimizerParams.LinearSolverType, "MULTIFRONTAL_SOLVER"):
        names.append("MULTIFRONTAL_SOLVER")
    return names


def timed(graph, start, solver, repeats):
    """Seconds, iterations and result with a linear solver."""
    best, total = math.inf, 0.0
    parameters = gtsam.GaussNewtonParams()
    parameters.setLinearSolverType(solver)
    for _ in range(repeats):
        clock = time.perf_counter()
        optimizer = gtsam.GaussNewtonOptimizer(graph, start, parameters)
        try:
            result, iterations = optimizer.optimize(), optimizer.iterations()
        except RuntimeError:  # an indeterminate system
            result, iterations = start, None
        seconds = time.perf_counter() - clock
        best, total = min(best, seconds), total + seconds
        if total > 3:
            break
    return best, iterations, result, solver


if __name__ == "__main__":
    main(*sys.argv[1:])

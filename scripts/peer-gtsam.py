#!/usr/bin/env python3
"""Optimises a g2o graph by gtsam's Gauss-Newton with its defaults, for `cargo xtask measure optimize`: prints one JSON object.

Usage: peer-gtsam.py SOURCE.g2o TARGET.g2o REPEATS        (needs: pip install gtsam)

The best time of the repeats, or of as many as take 3 s. `iterations` is null where the system is indeterminate.
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
    best, total = math.inf, 0.0
    for _ in range(int(repeats)):
        clock = time.perf_counter()
        optimizer = gtsam.GaussNewtonOptimizer(graph, start, gtsam.GaussNewtonParams())
        try:
            result, iterations = optimizer.optimize(), optimizer.iterations()
        except RuntimeError:  # an indeterminate system
            result, iterations = start, None
        seconds = time.perf_counter() - clock
        best, total = min(best, seconds), total + seconds
        if total > 3:
            break
    gtsam.writeG2o(graph, result, target)
    print(json.dumps({"seconds": best, "iterations": iterations}))


if __name__ == "__main__":
    main(*sys.argv[1:])

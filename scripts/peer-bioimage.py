#!/usr/bin/env python3
"""Solves an mc file with bioimage-cpp, for `cargo xtask measure multicut`: prints one JSON object.

Usage: peer-bioimage.py gaec|klj FILE.mc   (needs: pip install bioimage-cpp)
"""

import json
import resource
import sys

import bioimage_cpp
import numpy as np
from bioimage_cpp.graph import UndirectedGraph, multicut


def cpu():
    return resource.getrusage(resource.RUSAGE_SELF).ru_utime + resource.getrusage(resource.RUSAGE_SELF).ru_stime


def main():
    algorithm, path = sys.argv[1:]
    with open(path, "rb") as file:
        file.readline()
        table = np.fromstring(file.read(), dtype=np.float64, sep=" ").reshape(-1, 3)
    ends, costs = table[:, :2].astype(np.uint64), table[:, 2].copy()
    # Parallel edges add, as everywhere; self-loops cannot be cut.
    ends.sort(axis=1)
    keep = ends[:, 0] != ends[:, 1]
    unique, place = np.unique(ends[keep], axis=0, return_inverse=True)
    costs = np.bincount(place.ravel(), weights=costs[keep], minlength=len(unique))
    started = cpu()
    graph = UndirectedGraph.from_edges(int(ends.max()) + 1, unique)
    objective = multicut.MulticutObjective(graph, costs)
    solver = multicut.GreedyAdditiveMulticut()
    if algorithm == "klj":
        solver = multicut.ChainedMulticutSolvers([solver, multicut.KernighanLinMulticut()])
    labels = np.asarray(solver.optimize(objective))
    seconds = cpu() - started
    cut = labels[unique[:, 0].astype(np.int64)] != labels[unique[:, 1].astype(np.int64)]
    print(json.dumps({
        "objective": float(costs[cut].sum()),
        "solve_cpu_seconds": seconds,
        "version": bioimage_cpp.__version__,
    }))


if __name__ == "__main__":
    main()

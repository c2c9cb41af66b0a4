"""Whether gtsam reads the same poses, measurements and information from a g2o file as are in the graph.

Usage: files.py FOLDER (with plane.jsonl, plane.g2o, space.jsonl and space.g2o)
"""

import json
import sys

import gtsam
import numpy

work = sys.argv[1]


def close(ours, theirs, what, tolerance=1e-12):
    ours, theirs = numpy.asarray(ours), numpy.asarray(theirs)
    distance = numpy.abs(ours - theirs).max() / max(1.0, numpy.abs(ours).max())
    if not distance <= tolerance:
        sys.exit(f"{what}: {ours} in the file, {theirs} in gtsam")
    return distance


def matrix(pose):
    """The pose as gtsam holds it, as a matrix: quaternions of either sign are one rotation."""
    if len(pose) == 3:
        return gtsam.Pose2(*pose).matrix()
    x, y, z, qx, qy, qz, qw = pose
    return gtsam.Pose3(gtsam.Rot3.Quaternion(qw, qx, qy, qz), [x, y, z]).matrix()


for name, spatial in (("plane", False), ("space", True)):
    lines = [json.loads(line) for line in open(f"{work}/{name}.jsonl")]
    models = lines[0].get("noise_models", {})
    nodes = [line for line in lines if line["kind"] == "node"]
    edges = [line for line in lines if line["kind"] in ("odometry", "landmark") and "measurement" in line]
    graph, values = gtsam.readG2o(f"{work}/{name}.g2o", spatial)
    if values.size() != len(nodes) or graph.size() != len(edges):
        sys.exit(f"{name}: {len(nodes)} nodes and {len(edges)} edges; gtsam has {values.size()} and {graph.size()}")

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

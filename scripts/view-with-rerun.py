#!/usr/bin/env python3
"""Show a pose graph in the rerun viewer, or save it for later.

Usage: scripts/view-with-rerun.py GRAPH.jsonl [--save FILE.rrd]

Sessions are lines of their own colours; landmark edges in use are green, rejected ones grey, and incorrect ones in use red
(where the truth is known). Poses of the truth are a thin white line. Needs rerun-sdk (pip install rerun-sdk).
"""

import argparse
import gzip
import json
import sys

try:
    import rerun
except ImportError:
    sys.exit("rerun-sdk is not installed: pip install rerun-sdk")

COLOURS = {"used": (60, 170, 80), "rejected": (150, 150, 150), "incorrect": (220, 40, 40)}


def position(pose):
    """Metres in space; a planar pose lies at height 0."""
    return [pose[0], pose[1], pose[2] if len(pose) == 7 else 0.0]


def kind_of(edge):
    """In use, rejected, or in use and known to be incorrect."""
    if "rejected_by" in edge:
        return "rejected"
    return "incorrect" if edge.get("truth", {}).get("correct") is False else "used"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("graph")
    parser.add_argument("--save", metavar="FILE.rrd", help="write a recording instead of opening the viewer")
    arguments = parser.parse_args()
    sessions, truths, places, edges = {}, {}, {}, {}
    with open(arguments.graph, "rb") as raw:
        opened = gzip.open(raw) if raw.read(2) == b"\x1f\x8b" else raw
        raw.seek(0)
        for line in opened:
            record = json.loads(line)
            if record["kind"] == "node" and "pose" in record:
                places[record["id"]] = position(record["pose"])
                sessions.setdefault(record.get("session", "0"), []).append(places[record["id"]])
            if record["kind"] == "node" and "pose" in record.get("truth", {}):
                truths.setdefault(record.get("session", "0"), []).append(position(record["truth"]["pose"]))
            if record["kind"] == "landmark":
                edges.setdefault(kind_of(record), []).append((record["from"], record["to"]))

    # Everything is read before an old recording is written over.
    rerun.init("posecut", spawn=arguments.save is None)
    if arguments.save:
        rerun.save(arguments.save)

    for name, line in sessions.items():
        rerun.log(f"sessions/{name}", rerun.LineStrips3D([line]), static=True)
    for name, line in truths.items():
        rerun.log(f"truth/{name}", rerun.LineStrips3D([line], colors=[(255, 255, 255)], radii=[0.05]), static=True)
    for kind, pairs in edges.items():
        strips = [[places[a], places[b]] for a, b in pairs if a in places and b in places]
        rerun.log(f"landmark_edges/{kind}", rerun.LineStrips3D(strips, colors=[COLOURS[kind]]), static=True)
    counts = ", ".join(f"{len(pairs)} {kind}" for kind, pairs in sorted(edges.items()))
    print(f"{len(places)} nodes of {len(sessions)} sessions; landmark edges: {counts or 'none'}")


if __name__ == "__main__":
    try:
        main()
    except (OSError, KeyError, ValueError) as error:
        sys.exit(f"view-with-rerun.py: error: {error!r}")

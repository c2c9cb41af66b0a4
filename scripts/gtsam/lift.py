"""Writes a pose graph of the plane as one in space: the same drive, lifted and rolled.

Usage: lift.py GRAPH.jsonl OUTPUT.jsonl
"""

import json
import math
import sys


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

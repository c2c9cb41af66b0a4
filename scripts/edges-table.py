#!/usr/bin/env python3
"""Writes a table of landmark edges from collected results into a document.

Usage: scripts/edges-table.py RESULTS --rows LABEL[,LABEL...] --columns LABEL|PATTERN... [--cell CELL] -o DOCUMENT --section NAME

RESULTS is what `posecut-experiment collect` writes. Rows are the values of the labels. Columns are the values of one label,
or, given with several words, patterns of sessions and graphs whose runs are added up (NAME=PATTERN names a column).
The table replaces what is between `<!-- begin: NAME -->` and `<!-- end: NAME -->`.
"""

import argparse
import fnmatch
import json
import pathlib
import sys

from splice import splice


def precision_recall(runs):
    """Precision and recall of the edges of all runs together."""
    edges = [run["edges"] for run in runs]
    kept_right, kept_wrong, lost = (sum(edge[name] for edge in edges)
                                    for name in ("true_positive", "false_positive", "false_negative"))
    kept, right = kept_right + kept_wrong, kept_right + lost
    return f"{kept_right / kept if kept else 1:.3f} / {kept_right / right if right else 1:.3f}"


def kept_lost_rmse(runs):
    """False edges kept, correct edges lost, mean RMSE in metres."""
    wrong = sum(run["edges"]["false_positive"] for run in runs)
    lost = sum(run["edges"]["false_negative"] for run in runs)
    return f"{wrong} / {lost} / {sum(run['rmse'] for run in runs) / len(runs):.2f}"


CELLS = {"precision-recall": precision_recall, "kept-lost-rmse": kept_lost_rmse}


def cell(runs, write):
    if not runs:
        return "–"
    failed = sum("failed" in run for run in runs)
    return f"{failed} of {len(runs)} failed" if failed else write(runs)


def unique(values):
    return list(dict.fromkeys(values))


def table(results, rows, columns, write):
    def row_of(run):
        return tuple(str(run["labels"].get(label, "–")) for label in rows)

    if len(columns) == 1 and "=" not in columns[0] and all(columns[0] in run["labels"] for run in results):
        label = columns[0]
        chosen = [(str(value), lambda run, value=value: run["labels"][label] == value)
                  for value in unique(run["labels"][label] for run in results)]
    else:
        named = [text.split("=", 1) if "=" in text else (text, text) for text in columns]
        chosen = [(name, lambda run, pattern=pattern: fnmatch.fnmatch(run["labels"]["session"], pattern))
                  for name, pattern in named]
    header = list(rows) + [name for name, _ in chosen]
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(rows) + "---:|" * len(chosen)]
    for row in unique(row_of(run) for run in results):
        own = [run for run in results if row_of(run) == row]
        cells = [cell([run for run in own if belongs(run)], write) for _, belongs in chosen]
        lines.append("| " + " | ".join([*row, *cells]) + " |")
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=pathlib.Path)
    parser.add_argument("--rows", required=True)
    parser.add_argument("--columns", required=True, nargs="+")
    parser.add_argument("--cell", choices=CELLS, default="precision-recall")
    parser.add_argument("-o", "--output", required=True, type=pathlib.Path)
    parser.add_argument("--section", required=True)
    arguments = parser.parse_args()
    results = [json.loads(line) for line in arguments.results.open()]
    if not results:
        sys.exit(f"{arguments.results}: has no results; run the experiment first")
    lines = table(results, arguments.rows.split(","), arguments.columns, CELLS[arguments.cell])
    if f"<!-- begin: {arguments.section} -->" not in arguments.output.read_text():
        sys.exit(f"{arguments.output}: has no section <!-- begin: {arguments.section} --> ... <!-- end: {arguments.section} -->")
    splice(arguments.output, arguments.section, "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()

#!/bin/sh
# Labels candidates by the map that the whole pipeline makes of their log: no one measured the building.
#
# Usage: pipelines/label-by-map.sh [--ingest PROGRAM] [--recognize PROGRAM] [--verify PROGRAM]
#                                  [--optimize PROGRAM] [--label PROGRAM] GRAPH OUTPUT LOG
# An edge is correct if its measurement is within 0.5 m and 5.73 degrees (0.1 rad) of the map. The map is made of LOG with the
# default options of all stages, whatever those of GRAPH are.
# PROGRAM [default: those of target/release].
# shellcheck disable=SC2154,SC2034 # programs.sh reads stages and others, and sets the variables of programs.
set -eu
stages='ingest recognize verify optimize label' others=''
here=$(dirname "$0")
# shellcheck source=pipelines/programs.sh
. "$here/programs.sh"
[ $# -eq 3 ] || { sed -n '2,9s/^# \{0,1\}//p' "$0" >&2; exit 2; }
graph=$1 output=$2 log=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$here/laser-graph.sh" --ingest "$ingest" --recognize "$recognize" "$log" "$work/graph.jsonl"
"$verify" --quiet "$work/graph.jsonl" -o "$work/judged.jsonl"
"$optimize" --quiet "$work/judged.jsonl" -o "$work/map.jsonl"
"$label" --quiet "$graph" --ground-truth "$work/map.jsonl" --tolerance-translation 0.5 --tolerance-rotation 5.73 -o "$output"

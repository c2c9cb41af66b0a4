#!/bin/sh
# Labels candidates of a log: by measured relations if there are any, else by the map that the whole pipeline makes of the log, because no
# one measured the building.
#
# Usage: pipelines/label-by-map.sh [--ingest PROGRAM] [--recognize PROGRAM] [--verify PROGRAM]
#                                  [--optimize PROGRAM] [--label PROGRAM] GRAPH OUTPUT LOG [RELATIONS]
# An edge is correct if its measurement is within the distances in pipelines/laser-tolerance of the map. The map is made of LOG with the
# default options of all stages, whatever those of GRAPH are.
# PROGRAM [default: those of target/release].
# shellcheck disable=SC2154,SC2034 # programs.sh reads stages and others, and sets the variables of programs.
set -eu
stages='ingest recognize verify optimize label' others=''
here=$(dirname "$0")
# shellcheck source=pipelines/programs.sh
. "$here/programs.sh"
[ $# -eq 3 ] || [ $# -eq 4 ] || { sed -n '2,9s/^# \{0,1\}//p' "$0" >&2; exit 2; }
graph=$1 output=$2 log=$3 relations=${4:-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ -n "$relations" ]; then
  "$ingest" --quiet "$log" --scan-matching --trajectory "$work/trajectory.tum" -o "$work/session.jsonl"
  set -- --relations "$relations" --trajectory "$work/trajectory.tum"
else
  "$here/laser-graph.sh" --ingest "$ingest" --recognize "$recognize" "$log" "$work/graph.jsonl"
  "$verify" --quiet "$work/graph.jsonl" -o "$work/judged.jsonl"
  "$optimize" --quiet "$work/judged.jsonl" -o "$work/map.jsonl"
  set -- --ground-truth "$work/map.jsonl"
fi
# shellcheck disable=SC2046 # the tolerances are words
"$label" --quiet "$graph" "$@" $(cat "$here/laser-tolerance") -o "$output"

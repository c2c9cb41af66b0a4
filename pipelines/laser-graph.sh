#!/bin/sh
# A pose graph with candidates of place recognition, from a laser log.
#
# Usage: pipelines/laser-graph.sh [--ingest PROGRAM] [--recognize PROGRAM] LOG OUTPUT [OPTIONS]
# OPTIONS are those of posecut-recognize.
# PROGRAM [default: posecut-ingest and posecut-recognize of target/release].
# shellcheck disable=SC2154,SC2034 # programs.sh reads stages and others, and sets the variables of programs.
set -eu
stages='ingest recognize' others=''
# shellcheck source=pipelines/programs.sh
. "$(dirname "$0")/programs.sh"
[ $# -ge 2 ] || { sed -n '2,6s/^# \{0,1\}//p' "$0" >&2; exit 2; }
log=$1 output=$2
shift 2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$ingest" --quiet "$log" --scan-matching -o "$work/session.jsonl"
"$recognize" --quiet "$work/session.jsonl" "$@" -o "$output"

#!/bin/sh
# A pose graph with candidates of place recognition, from a laser log.
#
# Usage: pipelines/laser-graph.sh [--ingest PROGRAM] [--recognize PROGRAM] LOG OUTPUT [OPTIONS]
# OPTIONS are those of posecut-recognize.
# PROGRAM [default: posecut-ingest and posecut-recognize of target/release].
set -eu
programs=$(dirname "$0")/../target/release
ingest=$programs/posecut-ingest recognize=$programs/posecut-recognize
while [ $# -gt 0 ]; do
  case $1 in
    --ingest) ingest=$2 && shift 2 ;;
    --recognize) recognize=$2 && shift 2 ;;
    --version) echo 'laser-graph.sh 0.1.0' && exit ;;
    *) break ;;
  esac
done
[ $# -ge 2 ] || { sed -n '2,6s/^# \{0,1\}//p' "$0" >&2; exit 2; }
log=$1 output=$2
shift 2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$ingest" --quiet "$log" --scan-matching -o "$work/session.jsonl"
"$recognize" --quiet "$work/session.jsonl" "$@" -o "$output"

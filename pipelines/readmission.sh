#!/bin/sh
# PCM, then re-admission with the optimiser's marginals, in rounds: optimise what is in use, compare every landmark edge
# with what the others predict, re-admit and drop, until nothing changes (at most five rounds).
#
# Usage: pipelines/readmission.sh [--pcm PROGRAM] [--readmit PROGRAM] [--optimize PROGRAM] [--rounds FILE]
#                                 GRAPH OUTPUT [PCM OPTIONS]
# PCM OPTIONS are those of the first run [default: --calibrate --grow 0.999999].
# PROGRAM [default: posecut-pcm, posecut-readmit and posecut-optimize of target/release]; READMISSION holds the options of the
# rounds [default: --scale auto --apply-scale].
# OUTPUT is the optimised graph with the rejections of the last round; FILE gets a line of figures a round.
# shellcheck disable=SC2154,SC2034 # programs.sh reads stages and others, and sets the variables of programs.
set -eu
stages='pcm readmit optimize' others=rounds
# shellcheck source=pipelines/programs.sh
. "$(dirname "$0")/programs.sh"
[ $# -ge 2 ] || { sed -n '2,10s/^# \{0,1\}//p' "$0" >&2; exit 2; }
graph=$1 output=$2
shift 2
[ $# -gt 0 ] || set -- --calibrate --grow 0.999999
# The rounds re-admit by the same bound on chance as the first run.
chance='' before=''
for word in "$@"; do
  case $word in --chance=*) chance=$word ;; esac
  [ "$before" != --chance ] || chance="--chance $word"
  before=$word
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$pcm" --quiet "$graph" "$@" -o "$work/judged.jsonl"
: > "$work/rounds"
for round in 1 2 3 4 5; do
  "$optimize" --quiet "$work/judged.jsonl" --marginals landmark -o "$work/optimized.jsonl"
  # shellcheck disable=SC2086 # options are words
  "$readmit" --quiet "$work/optimized.jsonl" ${READMISSION---scale auto --apply-scale} $chance -o "$work/judged.jsonl" \
    --stats "$work/stats.json"
  figure() { sed -n "s/^  \"$1\": \([^,]*\),\{0,1\}$/\1/p" "$work/stats.json"; }
  echo "round $round readmitted $(figure readmitted) dropped $(figure dropped) scale $(figure scale)" >> "$work/rounds"
  [ "$(figure changed)" != 0 ] || break
done
"$optimize" --quiet "$work/judged.jsonl" -o "$output"
cat "$work/rounds" > "$rounds"

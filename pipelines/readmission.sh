#!/bin/sh
# PCM, then re-admission with the optimiser's marginals, in rounds: optimise what is in use, hold every landmark edge
# against what the others predict, take back and drop, and again until nothing changes (at most five rounds).
#
# Usage: pipelines/readmission.sh GRAPH OUTPUT [PCM OPTIONS]
# PCM OPTIONS are those of the first run, --calibrate --grow 0.999999 if there are none.
# Programs: PCM and OPTIMIZE (default posecut-pcm and posecut-optimize of target/release), options of the rounds: READMIT.
# OUTPUT is the optimised graph with the rejections of the last round; OUTPUT.rounds has a line of figures a round.
set -eu
[ $# -ge 2 ] || { sed -n '2,8s/^# \{0,1\}//p' "$0" >&2; exit 2; }
graph=$1 output=$2
shift 2
[ $# -gt 0 ] || set -- --calibrate --grow 0.999999
programs=$(dirname "$0")/../target/release
pcm=${PCM:-$programs/posecut-pcm}
optimize=${OPTIMIZE:-$programs/posecut-optimize}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$pcm" --quiet "$graph" "$@" -o "$work/judged.jsonl"
: > "$work/rounds"
for round in 1 2 3 4 5; do
  "$optimize" --quiet "$work/judged.jsonl" --marginals landmark -o "$work/optimized.jsonl"
  # shellcheck disable=SC2086 # options are words
  "$pcm" --quiet "$work/optimized.jsonl" --readmit ${READMIT---scale auto --apply-scale} -o "$work/judged.jsonl" \
    --stats "$work/stats.json"
  figure() { sed -n "s/^  \"$1\": \([^,]*\),\{0,1\}$/\1/p" "$work/stats.json"; }
  echo "round $round readmitted $(figure readmitted) dropped $(figure dropped) scale $(figure scale)" >> "$work/rounds"
  [ "$(figure changed)" != 0 ] || break
done
"$optimize" --quiet "$work/judged.jsonl" -o "$output"
cp "$work/rounds" "$output.rounds"

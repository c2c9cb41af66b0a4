#!/bin/sh
# Fetches sessions with scripts/fetch-nclt.sh from a server on this machine: whole and damaged files, what is already there, what was
# interrupted, and what is missing. Skipped without curl or python3.
# Usage: scripts/check-fetch.sh [SCRIPT]
set -eu
cd "$(dirname "$0")/.."
script=${1:-scripts/fetch-nclt.sh}
for tool in curl python3; do
  command -v "$tool" >/dev/null || { echo "skipped: check-fetch: $tool is not installed"; exit 0; }
done
work=$(mktemp -d)
server=
trap '[ -z "$server" ] || kill "$server"; rm -rf -- "$work"' EXIT

served=$work/served
mkdir -p "$served/ground_truth" "$served/covariance" "$served/sensor_data"
session() { # date columns
  seq 3 | awk -v columns="$2" '{ printf $1; for (i = 1; i < columns; i++) printf ",0.5"; print "" }' \
    >"$served/ground_truth/groundtruth_$1.csv"
  echo x | gzip >"$served/sensor_data/$1_sen.tar.gz"
}
session 2012-01-22 7
session 2012-03-31 7
seq 3 | awk '{ printf $1; for (i = 1; i < 22; i++) printf ",0.5"; print "" }' >"$served/covariance/cov_2012-01-22.csv"
session 2012-08-04 6

: >"$work/port"
python3 -u -m http.server --bind 127.0.0.1 --directory "$served" 0 >"$work/port" 2>/dev/null &
server=$!
until port=$(sed -n 's/.* port \([0-9]*\) .*/\1/p' "$work/port") && [ -n "$port" ]; do sleep 0.1; done
export POSECUT_NCLT_URL="http://127.0.0.1:$port"

# A run must end with the status and say the text.
expect() { # status text argument…
  wanted=$1 text=$2
  shift 2
  status=0
  said=$(sh "$script" -o "$work/nclt" "$@" 2>&1 </dev/null) || status=$?
  case $status:$said in
    "$wanted:"*"$text"*) ;;
    *) echo "check-fetch: $*: status $status, and not \"$text\": $said"; exit 1 ;;
  esac
}
expect 0 'To download:' -n 2012-01-22
[ ! -e "$work/nclt" ] || { echo 'check-fetch: -n downloads'; exit 1; }
expect 0 'All there.' 2012-01-22
cmp "$served/covariance/cov_2012-01-22.csv" "$work/nclt/cov_2012-01-22.csv"
expect 0 'already there' 2012-01-22
# This server cannot go on in the middle.
mkdir -p "$work/nclt"
printf 1 >"$work/nclt/groundtruth_2012-03-31.csv.part"
expect 0 'posecut does not need it' 2012-03-31
cmp "$served/ground_truth/groundtruth_2012-03-31.csv" "$work/nclt/groundtruth_2012-03-31.csv"
expect 1 'line 1: expected 7 columns, found 6' 2012-08-04
[ ! -e "$work/nclt/groundtruth_2012-08-04.csv" ] || { echo 'check-fetch: a damaged file is kept'; exit 1; }
expect 1 'failed: 2013-04-05' 2012-01-22 2013-04-05
expect 2 'is no date' 2012-13-01
expect 2 'unknown option -x' -x
POSECUT_NCLT_URL=http://127.0.0.1:1 expect 1 'the server does not answer' 2012-01-22
echo 'sessions are fetched whole or not at all'

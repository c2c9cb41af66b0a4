#!/bin/sh
# Runs every method of the trust benchmark on two simulated sessions. Checks that no method fails and that the page has all methods.
#
# Usage: scripts/check-trust.sh [FOLDER OF RESULTS]; needs the release programs. It takes about half a minute.
set -eu
cd "$(dirname "$0")/.."
programs=${CARGO_TARGET_DIR:-target}/release
results=${1:-results/trust-sample}
mkdir -p "$results"

of="pipelines/trust/sample.toml --programs $programs --simulated $results/sessions --data $results --results $results"
# shellcheck disable=SC2086 # options are words
"$programs/posecut-experiment" run $of --quiet
# shellcheck disable=SC2086
"$programs/posecut-experiment" collect $of --quiet -o "$results/results.jsonl" --times "$results/times.jsonl"
"$programs/posecut-report" trust "$results/results.jsonl" --times "$results/times.jsonl" -o "$results/trust.md" \
  --figure "$results/regret.svg"

methods=$(sed -n '/^methods/,/^]/p' pipelines/trust/methods.toml | grep -o '"[^"]*"' | tr -d '"')
status=0
for method in $methods; do
  runs=$(grep -c "\"method\":\"$method\"" "$results/results.jsonl" || true)
  failed=$(grep "\"method\":\"$method\"" "$results/results.jsonl" | grep -c '"failed"' || true)
  [ "$runs" = 2 ] && [ "$failed" = 0 ] || { echo "$method: $runs of 2 runs, $failed failed"; status=1; }
  grep -q "^| $method " "$results/trust.md" || { echo "$method: is not in the tables"; status=1; }
done
[ "$status" != 0 ] || echo "trust: $(echo "$methods" | wc -l) methods on 2 graphs, none failed; all are in the tables"
exit $status

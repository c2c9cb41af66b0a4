#!/bin/sh
# Gives hostile input to every reader and stage for SECONDS [default: 60], within 3 GB of memory. Further arguments go to the fuzzer
# (names of targets, --seed, …). Findings go to target/fuzz; exit status 1 if there is any.
set -eu
cd "$(dirname "$0")/.."
seconds=${1:-60}
[ $# -eq 0 ] || shift
cargo build --release --quiet --locked --workspace --example fuzz
# shellcheck disable=SC3045 # dash and bash have -v.
ulimit -v 3000000
exec "${CARGO_TARGET_DIR:-target}/release/examples/fuzz" --seconds "$seconds" "$@"

#!/bin/sh
# Gives hostile input to every reader and stage for SECONDS (60 unless told), within 3 GB of memory; further arguments go
# to the fuzzer (names of targets, --seed, …). Findings go to target/fuzz. Exit status 1 if there is one.
set -eu
cd "$(dirname "$0")/.."
seconds=${1:-60}
[ $# -eq 0 ] || shift
cargo build --release --quiet --locked --workspace --example fuzz
ulimit -v 3000000
exec "${CARGO_TARGET_DIR:-target}/release/examples/fuzz" --seconds "$seconds" "$@"

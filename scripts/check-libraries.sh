#!/bin/sh
# Libraries of algorithms build without their programs (no feature `cli`), and then depend on neither clap nor posecut-stage.
set -eu
cd "$(dirname "$0")/.."
for manifest in crates/*/Cargo.toml; do
  grep -q '^cli = ' "$manifest" || continue
  name=$(sed -n 's/^name = "\(posecut-[a-z-]*\)"$/\1/p' "$manifest" | head -1)
  cargo clippy --quiet --locked --lib --no-default-features -p "$name" -- -D warnings
  needed=$(cargo tree --locked -p "$name" --no-default-features -e normal --prefix none | sed -n 's/^\(clap\|posecut-stage\) .*/\1/p' | sort -u)
  [ -z "$needed" ] || { echo "check-libraries: $name depends on $needed without the feature cli"; exit 1; }
done

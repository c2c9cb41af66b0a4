#!/bin/sh
# Libraries of algorithms build without their programs (no feature `cli`), and then depend on neither clap nor posecut-stage.
set -eu
cd "$(dirname "$0")/.."
names=
for manifest in crates/*/Cargo.toml; do
  grep -q '^cli = ' "$manifest" || continue
  name=$(sed -n 's/^name = "\(posecut-[a-z-]*\)"$/\1/p' "$manifest" | head -1)
  names="$names $name"
done
# All at once: one after the other, they would ask for different features of other people's crates, which would be checked again.
# shellcheck disable=SC2046,SC2086 # lists of words
cargo clippy --quiet --locked --lib --no-default-features $(printf ' --package %s' $names) -- -D warnings
for name in $names; do
  needed=$(cargo tree --locked -p "$name" --no-default-features -e normal --prefix none | sed -n 's/^\(clap\|posecut-stage\) .*/\1/p' | sort -u)
  [ -z "$needed" ] || { echo "check-libraries: $name depends on $needed without the feature cli"; exit 1; }
done

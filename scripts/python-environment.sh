#!/bin/sh
# Prints the Python of an environment in target/python that has these PyPI packages, and installs the missing ones. Exit status 1 if
# it cannot. All scripts share the environment, because most of these packages need the same large ones.
# Usage: scripts/python-environment.sh PACKAGE...
set -eu
environment=$(dirname "$0")/../target/python
has_all() {
  "$environment/bin/python" -c "import importlib, sys; [importlib.import_module(name) for name in sys.argv[1:]]" "$@"
}
install_all() {
  { [ -x "$environment/bin/pip" ] || python3 -m venv "$environment"; } && "$environment/bin/pip" install --quiet "$@"
}
if has_all "$@" || { install_all "$@" && has_all "$@"; }; then
  echo "$environment/bin/python" >&3
else
  exit 1
fi 3>&1 >/dev/null 2>&1

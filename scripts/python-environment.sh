#!/bin/sh
# Prints the Python of an environment of its own that has a PyPI package, which it installs if need be; exit status 1 where
# it cannot.
# Usage: scripts/python-environment.sh PACKAGE
set -eu
package=$1
environment=$(dirname "$0")/../target/$package
has_it() {
  "$environment/bin/python" -c "import $package"
}
install_it() {
  python3 -m venv "$environment" && "$environment/bin/pip" install --quiet "$package" && has_it
}
if has_it || install_it; then
  echo "$environment/bin/python" >&3
else
  exit 1
fi 3>&1 >/dev/null 2>&1

#!/bin/sh
# Builds the wheel of the Python package, installs it into an environment of its own, runs its tests and mypy there, and compares the
# output of the examples in docs/python.md and docs/other-tools.md with these pages (--write puts the output there).
# Skipped if Python is missing or its packages cannot be installed. Without gtsam or evo, their tests are skipped.
# Usage: scripts/check-python.sh [--write]
set -eu
cd "$(dirname "$0")/.."
root=$PWD
write=
[ "${1:-}" != --write ] || write=yes
command -v python3 >/dev/null || { echo 'skipped: there is no python3'; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The environment of the scripts has other people's packages; this one adds the wheel.
installed=$(scripts/python-environment.sh numpy pytest mypy) || { echo 'skipped: pytest and mypy cannot be installed here'; exit 0; }
for package in gtsam evo; do
  scripts/python-environment.sh "$package" >/dev/null || echo "skipped: $package cannot be installed here"
done
"$installed" -m venv "$work/environment"
python=$work/environment/bin/python
packages='import sysconfig; print(sysconfig.get_path("purelib"))'
"$root/$installed" -c "$packages" >"$("$python" -c "$packages")/installed.pth"

# Shares its build with the tests and with make, which compile the same crates.
POSECUT_SHARED_BUILD=1 "$python" -m pip wheel --quiet --no-deps --wheel-dir "$work" .
wheel=$(find "$work" -maxdepth 1 -name 'posecut-*.whl')
echo "$(basename "$wheel"): $(($(wc -c <"$wheel") / 1000000)) MB"
"$python" -m pip install --quiet "$wheel"

# From another folder, so that only the wheel is found.
cd "$work"
version=$("$python" -c 'import posecut; print(posecut.__version__)')
for program in "$root"/crates/*/src/main.rs; do
  name=$(basename "$(dirname "$(dirname "$program")")")
  case $name in
    xtask) continue ;;
    posecut) name=posecut ;;
    *) name=posecut-$name ;;
  esac
  [ "$("$work/environment/bin/$name" --version)" = "$name $version" ] || { echo "the wheel lacks $name $version"; exit 1; }
done
"$python" -m pytest -q -p no:cacheprovider "$root/crates/python/tests"
"$python" -m mypy --config-file "$root/pyproject.toml" --cache-dir "$work/mypy" -p posecut

# PAGE NAME: runs the program NAME.py of a document, and compares its output with NAME.output there.
example() {
  "$root/scripts/extract.sh" "$root/$1" "$2.py" >recipe
  "$python" recipe >"$2.output"
  if [ "$write" ]; then
    awk -v output="$2.output" '
      skip && !/^```$/ { next }
      { print; skip = 0 }
      $0 == "<!-- file: " output " -->" { found = 1 }
      found && /^```/ { while ((getline line < output) > 0) print line; found = 0; skip = 1 }
    ' "$root/$1" >replaced
    cp replaced "$root/$1"
  elif "$root/scripts/extract.sh" "$root/$1" "$2.output" >expected && diff -u expected "$2.output"; then
    return
  else
    echo "$1 shows another output; scripts/check-python.sh --write puts this one there"
    exit 1
  fi
}
mkdir testdata
cp "$root/testdata/graph.jsonl" testdata/
example docs/python.md example
"$work/environment/bin/posecut-convert" -q clean.g2o -o clean.jsonl
if "$python" -c 'import gtsam' 2>/dev/null; then
  example docs/other-tools.md incremental
else
  echo 'skipped: without gtsam, the example of docs/other-tools.md'
fi

#!/bin/sh
# Builds the wheel of the Python package, installs it into a fresh environment, runs its tests and mypy there, and compares the output
# of the example in docs/python.md with the page (--write puts the output there).
# Skipped if Python is missing or its packages cannot be installed. Without gtsam or evo, their tests are skipped.
# Usage: scripts/check-python.sh [--write]
set -eu
cd "$(dirname "$0")/.."
root=$PWD
page=docs/python.md
write=
[ "${1:-}" != --write ] || write=yes
command -v python3 >/dev/null || { echo 'skipped: there is no python3'; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

python3 -m venv "$work/environment" || { echo 'skipped: python3 has no venv'; exit 0; }
python=$work/environment/bin/python
"$python" -m pip install --quiet numpy pytest mypy || { echo 'skipped: pytest and mypy cannot be installed here'; exit 0; }
for package in gtsam evo; do
  "$python" -m pip install --quiet "$package" || echo "skipped: $package cannot be installed here"
done

"$python" -m pip wheel --quiet --no-deps --wheel-dir "$work" .
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

"$root/scripts/extract.sh" "$root/$page" example.py >recipe
mkdir testdata
cp "$root/testdata/graph.jsonl" testdata/
"$python" recipe >example.output
"$work/environment/bin/posecut-convert" -q clean.g2o -o clean.jsonl
if [ "$write" ]; then
  awk -v output=example.output '
    skip && !/^```$/ { next }
    { print; skip = 0 }
    $0 == "<!-- file: example.output -->" { found = 1 }
    found && /^```/ { while ((getline line < output) > 0) print line; found = 0; skip = 1 }
  ' "$root/$page" >replaced
  cp replaced "$root/$page"
elif ! "$root/scripts/extract.sh" "$root/$page" example.output | diff -u - example.output; then
  echo "$page shows another output; scripts/check-python.sh --write puts this one there"
  exit 1
fi

#!/bin/sh
# Runs `make map` on a simulated log and checks its pictures, its counts and the section of the page; then without place recognition, then
# with another program in the same folder.
#
# Usage: scripts/check-map.sh [FOLDER OF RESULTS]; needs the release programs. It takes about ten seconds.
set -eu
cd "$(dirname "$0")/.."
unset MAKEFLAGS MAKELEVEL MFLAGS LOG RELATIONS INGEST RECOGNIZE VERIFY 2>/dev/null || true
programs=${CARGO_TARGET_DIR:-target}/release
results=${1:-results}
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT

fail() { echo "check-map: $1"; exit 1; }

# FILE: must be there and be a PNG.
picture() {
  [ -f "$1" ] || fail "$1 is missing"
  [ "$(head -c 4 "$1" | tail -c 3)" = PNG ] || fail "$1 is no PNG"
}

make --no-print-directory map "RESULTS=$results" >"$work/said" 2>"$work/log" || { cat "$work/log"; fail 'make map fails'; }
map=$results/map/robot
for name in map before all-candidates; do
  picture "$map/$name.png"
  grep -q "$map/$name.png" "$work/said" || fail "make map does not name $name.png"
done
cmp -s "$map/map.png" "$map/all-candidates.png" && fail 'nothing is rejected: the map is the same with all candidates'
cmp -s "$map/map.png" "$map/before.png" && fail 'no candidate is in use: the map is the same by odometry alone'
[ -f "$map/map.yaml" ] || fail 'there is no map for ROS'

# The counts of the page are those of the graph.
count() { grep '"kind":"landmark"' "$map/optimized.jsonl" | grep -c "$1" || true; }
all=$(count landmark) accepted=$(count '"verify_verdict":"accepted"') rejected=$(count '"verify_verdict":"rejected"')
undecided=$(count '"verify_verdict":"undecided"')
"$programs/posecut-report" html --quiet --map "$map" -o "$work/page.html"
row="<th scope=\"row\">robot</th><td>$all</td><td>$accepted</td><td>$rejected</td><td>$undecided</td>"
grep -q "$row" "$work/page.html" || fail "the page does not say $all candidates, $accepted accepted, $rejected rejected, $undecided undecided"
[ "$accepted" -gt 0 ] && [ "$rejected" -gt 0 ] || fail "$accepted candidates are accepted and $rejected rejected"
[ "$(grep -o '"picture":"iVBORw' "$work/page.html" | wc -l)" = 3 ] || fail 'the page has not three maps'

# Without place recognition only odometry is left.
make --no-print-directory map "RESULTS=$work/cat" RECOGNIZE=cat VERIFY=cat >"$work/said" 2>"$work/log" ||
  { cat "$work/log"; fail 'make map RECOGNIZE=cat VERIFY=cat fails'; }
picture "$work/cat/map/robot/map.png"
picture "$work/cat/map/robot/before.png"
[ ! -e "$work/cat/map/robot/all-candidates.png" ] || fail 'there is a map with all candidates, but there are no candidates'
if grep -q all-candidates "$work/said"; then fail 'make map names all-candidates.png, but does not make it'; fi
"$programs/posecut-report" html --quiet --map "$work/cat/map/robot" -o "$work/page.html"
grep -q 'There are no candidates in robot' "$work/page.html" || fail 'the page does not say that there are no candidates'

# In the same folder, only what depends on another program is made again.
touch "$work/before"
again() {
  make --no-print-directory map "RESULTS=$results" "$@" >"$work/said" 2>"$work/log" ||
    { cat "$work/log"; fail "make map $* fails"; }
}
newer() { [ -n "$(find "$map/$1" -newer "$work/before")" ]; }
again
newer optimized.jsonl && fail 'make map makes the map again, though nothing changed'
again VERIFY=cat
newer map.png || fail 'make map VERIFY=cat leaves the map of posecut-verify'
newer graph.jsonl && fail 'make map VERIFY=cat recognises places again'
[ ! -e "$map/all-candidates.jsonl" ] || fail 'the map with all candidates stays, though all are in use in the map itself'
again
grep -q '"verify_verdict"' "$map/judged.jsonl" || fail 'make map leaves the graph of VERIFY=cat'
echo "make map: $all candidates, $accepted accepted, $rejected rejected; three maps, and two without place recognition"

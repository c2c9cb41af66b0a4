#!/bin/sh
# Checks that the Makefile's variables never become commands, that `make clean` deletes only what a run created, and that a missing
# program is built. Needs no programs.
set -eu
cd "$(dirname "$0")/.."
unset MAKEFLAGS MAKELEVEL MFLAGS NCLT RESULTS SIMULATED SESSIONS DATA PREFIX DOCUMENT SEEDS PIPELINES METHODS FAMILIES HALF \
  EXPERIMENT FIGURES CASES LOG RELATIONS 2>/dev/null || true
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT

fail() { echo "check-makefile: $1"; exit 1; }

# NAME VALUE: `make help`, `make -n table` and `make clean` must refuse the value with a sentence that names the variable, and must not
# run any part of it.
refused() {
  for target in help '-n table' clean; do
    # shellcheck disable=SC2086 # -n is an option.
    if said=$(make --no-print-directory $target "$1=$2" 2>&1); then
      fail "make $target accepts $1=$2"
    fi
    case $said in
      *"$1"*"cannot be used"*) ;;
      *) fail "make $target $1=$2 says: $said" ;;
    esac
    [ ! -e "$work/owned" ] || fail "make $target runs $1=$2"
  done
}

for name in NCLT RESULTS SIMULATED DATA PREFIX DOCUMENT LOG RELATIONS; do
  refused $name "$work/a b"
  refused $name "-rf"
done
# All combinations are a thousand runs of make: the short form takes a third.
share=3 number=0
[ "${POSECUT_LONG_TESTS:-}" != 1 ] || share=1
for name in CARGO_TARGET_DIR BIN REPORT PCM VERIFY NCLT RESULTS SIMULATED SESSIONS DATA PREFIX DOCUMENT SEEDS PIPELINES METHODS FAMILIES HALF EXPERIMENT FIGURES CASES LOG RELATIONS; do
  for value in "x;touch $work/owned" "x'; touch $work/owned; '" "x\"; touch $work/owned; \"" "\$(shell touch $work/owned)" \
    "x\`touch $work/owned\`" "x|y" "x&y" "x>y" "x*" "x(y)" "x#y" "x:y" 'x\y' "x
y"; do
    # The number of values is no multiple of three, so every name and every value has its turn.
    number=$((number + 1))
    [ $((number % share)) -ne 0 ] || refused $name "$value"
  done
done
refused SESSIONS ../x
refused PREFIX ''
refused RESULTS ''
refused SIMULATED ''

# Values from the environment are refused like those of the command line.
for name in RESULTS DATA PREFIX CARGO_TARGET_DIR PCM; do
  if env "$name=x;touch $work/owned" make help >/dev/null 2>&1; then fail "make accepts $name of the environment"; fi
done

# Files that no run created stay.
clean() { make --no-print-directory clean "RESULTS=$work/results" "SIMULATED=$work/simulated"; }
mkdir "$work/results" "$work/other"
touch "$work/results/precious" "$work/other/precious"
if said=$(clean 2>&1); then fail "make clean deletes a folder that no run made: $said"; fi
case $said in *"has no .posecut-made"*) ;; *) fail "make clean says: $said" ;; esac
[ -f "$work/results/precious" ] || fail 'make clean deleted what no run made'
scripts/folders.sh mark "$work/results"
[ ! -e "$work/results/.posecut-made" ] || fail "a folder with other content was marked"
rm -r "$work/results"

# Files that a run created are deleted.
scripts/folders.sh mark "$work/results" "$work/simulated"
touch "$work/results/made" "$work/simulated/made"
clean
[ ! -e "$work/results" ] && [ ! -e "$work/simulated" ] || fail 'make clean left what a run made'

# Links are not followed.
scripts/folders.sh mark "$work/linked"
ln -s "$work/linked" "$work/results"
if clean >/dev/null 2>&1; then fail 'make clean deletes a link'; fi
[ -d "$work/linked" ] || fail 'make clean followed a link'

# A program that Cargo built by itself does not stand for all of them: Make builds the rest.
mkdir -p "$work/target/release"
touch "$work/target/release/posecut-experiment" "$work/target/release/posecut-report"
case $(CARGO_TARGET_DIR="$work/target" make --no-print-directory -n trust-sample) in
  *"cargo build"*) ;;
  *) fail 'make trust-sample builds no programs where there are two already' ;;
esac

make --no-print-directory help RESULTS=../results SIMULATED=~/x_1.0 SESSIONS='2012-01-22 a+b' >/dev/null || fail 'make refuses plain names'
echo 'the Makefile keeps to its folders and builds all programs'

#!/bin/sh
# Compares the ways of running one plan: make with one task at a time, the runner with two threads, the shares of a Slurm array one
# after the other, and two HyperQueue workers must write the same bytes. HyperQueue is skipped if it cannot be installed.
# Usage: scripts/check-sweep.sh [DIRECTORY_OF_PROGRAMS]
set -eu
cd "$(dirname "$0")/.."
programs=$(cd "${1:-target/release}" && pwd)
experiment=$programs/posecut-experiment
here=$(pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Each engine works in its own folder, with the same names.
prepare() { # ENGINE
  mkdir "$work/$1"
  cd "$work/$1"
  ln -s "$here/pipelines" pipelines
  "$experiment" plan pipelines/small.toml --quiet --programs "$programs" --format "$2" -o "$3"
}
# Results and session graphs. Journals and locks describe the run, not its result.
left() { # ENGINE
  cd "$work/$1"
  find data results -name '*.result.json' -o -name session.jsonl -o -name '*.csv' | LC_ALL=C sort | xargs sha256sum
}
same() { # ENGINE
  left "$1" > "$work/$1.sums"
  cmp "$work/make.sums" "$work/$1.sums"
  echo "$1: the same $(grep -c . "$work/$1.sums") files as make -j1"
}

prepare make make plan.mk
make --silent -j1 -f plan.mk
left make > "$work/make.sums"

prepare runner tasks plan.jsonl
"$experiment" run plan.jsonl --quiet --threads 2
same runner

prepare slurm tasks plan.jsonl
cat > sbatch <<'SBATCH'
#!/bin/sh
# A substitute for sbatch: runs the given command at once, an array share by share.
for word in "$@"; do
  case $word in --array=1-*) shares=${word#--array=1-} ;; esac
  command=$word
done
if [ -n "${shares:-}" ]; then
  for SLURM_ARRAY_TASK_ID in $(seq "$shares"); do export SLURM_ARRAY_TASK_ID; sh -c "$command" >&2; done
else
  sh -c "$command" >&2
fi
echo 1
SBATCH
chmod +x sbatch
SBATCH=./sbatch "$here/scripts/sweep-slurm.sh" plan.jsonl 3 "$experiment" > /dev/null 2>&1
same slurm

# The path is relative to the root; the engine works elsewhere.
python=$(cd "$here" && scripts/python-environment.sh hyperqueue) || { echo 'skipped: hyperqueue cannot be installed here'; exit 0; }
python=$here/$python
prepare hyperqueue tasks plan.jsonl
"$python" "$here/scripts/sweep-hyperqueue.py" plan.jsonl --workers 2 --program "$experiment" > log 2>&1 ||
  { cat log results/hyperqueue/*.log; exit 1; }
same hyperqueue

#!/bin/sh
# Runs a task list as a Slurm array: one job for the tasks that several runs share, then an array of shares of the runs. Finished
# tasks do not run again, so the same command resumes an interrupted sweep. Options after -- go to sbatch.
# Usage: scripts/sweep-slurm.sh PLAN.jsonl SHARES [PROGRAM] [-- SBATCH_OPTIONS...]
#   posecut-experiment plan pipelines/regimes.toml -o plan.jsonl
#   scripts/sweep-slurm.sh plan.jsonl 100 -- --time=1:00:00 --partition=short
# For a list that was planned with --results or --simulated: RESULTS=DIR SIMULATED=DIR scripts/sweep-slurm.sh plan.jsonl 100
# SBATCH=echo shows what would be submitted.
set -eu
plan=${1:?name a task list, as posecut-experiment plan writes it}
shares=${2:?say into how many shares the runs are divided}
shift 2
program=target/release/posecut-experiment
if [ $# -gt 0 ] && [ "$1" != -- ]; then program=$1; shift; fi
if [ $# -gt 0 ] && [ "$1" = -- ]; then shift; fi
[ -f "$plan" ] || { echo "$plan: there is no such task list; write it with posecut-experiment plan" >&2; exit 2; }
sbatch=${SBATCH:-sbatch}
places="--results '${RESULTS:-results}' --simulated '${SIMULATED:-data/simulated}'"
mkdir -p results/slurm

shared=$($sbatch --parsable --job-name=posecut-shared --ntasks=1 --cpus-per-task=1 --output=results/slurm/shared.log \
  "$@" --wrap "'$program' run '$plan' $places --threads 1 --shared")
echo "shared part: $shared"
array=$($sbatch --parsable --job-name=posecut-sweep --ntasks=1 --cpus-per-task=1 --array="1-$shares" \
  --dependency="afterok:${shared%%;*}" --output=results/slurm/share-%a.log \
  "$@" --wrap "'$program' run '$plan' $places --threads 1 --shard \$SLURM_ARRAY_TASK_ID/$shares")
echo "shares: $array"

#!/usr/bin/env bash
# A query and its report for every line of a list, as a Slurm job array, without Snakemake:
#   sbatch --array=1-$(wc -l <runs.txt)%20 scripts/workflow/slurm/array.sh DB DATASET.json \
#     runs.txt OUT
# Each line is a name and flags of vpr-query, such as "z20 --c-l 20 --score zscore". Lines
# with a report are skipped, so the same command resumes an interrupted run.
#SBATCH --job-name=vpr --cpus-per-task=1 --mem=4G --output=slurm-%A-%a.log
set -euo pipefail
[[ $# == 4 ]] || { echo "array.sh: usage: array.sh DB DATASET.json RUNS OUT" >&2; exit 2; }
database=$1 dataset=$2 list=$3 out=$4
PATH=${VPR_BIN:-$PWD/build/release/bin}:$PATH
line=$(sed -n "${SLURM_ARRAY_TASK_ID}p" "$list")
read -ra flags <<<"$line"
[[ ${#flags[@]} -gt 0 ]] || exit 0
run=$out/${flags[0]}
mkdir -p "$out"
[[ -e $run.report.json ]] && exit 0
vpr-query "$database" --dataset "$dataset" "${flags[@]:1}" --threads "$SLURM_CPUS_PER_TASK" \
  -o "$run.json" --force --quiet
vpr-eval "$run.json" --dataset "$dataset" --name "${flags[0]}" -o "$run.report.json" --quiet

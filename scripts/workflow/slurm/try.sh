#!/usr/bin/env bash
# Tests the job array and the profile with a one-node Slurm that it starts on this machine as root
# and stops at the end:
#   VPR_BIN=DIR scripts/workflow/slurm/try.sh
# Needs slurmctld, slurmd, slurm-client, munge and snakemake (apt). Not part of any test.
set -euo pipefail
cd "$(dirname "$0")/../../.."
for program in slurmctld slurmd sbatch munged snakemake; do
  command -v "$program" >/dev/null || { echo "try.sh: $program is missing" >&2; exit 77; }
done
VPR_BIN=$(realpath -m "${VPR_BIN:-build/release/bin}")
[[ -x $VPR_BIN/vpr-synth ]] || { echo "try.sh: $VPR_BIN/vpr-synth is missing" >&2; exit 2; }
at=$(mktemp -d)
chmod 755 "$at"
export VPR_BIN SLURM_CONF=$at/slurm.conf
stop() {
  for pid in "$at"/*.pid; do [[ -e $pid ]] && kill "$(cat "$pid")" 2>/dev/null; done
  sleep 2
  rm -rf "$at"
}
trap stop EXIT

# One node with two processors, no accounting, no cgroups.
head -c 1024 /dev/urandom >"$at/munge.key"
chmod 400 "$at/munge.key"
munged --force --key-file="$at/munge.key" --socket="$at/munge.sock" --pid-file="$at/munged.pid" \
  --log-file="$at/munged.log" --seed-file="$at/munge.seed"
mkdir "$at/state" "$at/spool"
node=$(hostname -s)
cat >"$SLURM_CONF" <<END
ClusterName=try
SlurmctldHost=$node(127.0.0.1)
SlurmctldPort=16817
SlurmdPort=16818
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$at/munge.sock
CryptoType=crypto/munge
StateSaveLocation=$at/state
SlurmdSpoolDir=$at/spool
SlurmctldPidFile=$at/slurmctld.pid
SlurmdPidFile=$at/slurmd.pid
SlurmctldLogFile=$at/slurmctld.log
SlurmdLogFile=$at/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
ReturnToService=2
NodeName=$node NodeAddr=127.0.0.1 CPUs=2 RealMemory=8000 State=UNKNOWN
PartitionName=all Nodes=$node Default=YES MaxTime=INFINITE State=UP
END
slurmctld
slurmd
for _ in {1..30}; do [[ $(sinfo -h -o %T 2>/dev/null) == idle ]] && break; sleep 1; done
sinfo

echo; echo "== a job array"
"$VPR_BIN/vpr-synth" test/golden/world.json -o "$at/building" --quiet
"$VPR_BIN/vpr-train" fastable --dataset "$at/building/dataset.json" --c-l 5 -o "$at/w.vprdb" --quiet
printf '%s\n' "raw5 --c-l 5" "raw6 --c-l 6" "z5 --c-l 5 --score zscore" >"$at/runs.txt"
array=(sbatch --wait --array=1-3 --mem=1G --output="$at/array-%a.log"
  scripts/workflow/slurm/array.sh
  "$at/w.vprdb" "$at/building/dataset.json" "$at/runs.txt" "$at/array")
"${array[@]}" || { cat "$at"/array-*.log "$at"/slurm*.log; exit 1; }
rm "$at/array/raw6.report.json"
before=$(stat -c %Y.%n "$at/array/raw5.report.json" "$at/array/z5.report.json")
"${array[@]}"
[[ $before == "$(stat -c %Y.%n "$at/array/raw5.report.json" "$at/array/z5.report.json")" ]]
"$VPR_BIN/vpr-eval" compare "$at"/array/{raw5,raw6,z5}.report.json | head -8

echo; echo "== the profile"
late_job=$(sbatch --parsable --mem=100 --time=1 --output=/dev/null --wrap "sleep 600")
cat >"$at/experiments.yaml" <<END
schema: vpr.experiments/3
memory_mb: 1000
data: {golden: {world: $PWD/test/golden/world.json}}
descriptors: {ldb: {}}
grids: {c_l: [5, 6]}
methods: {raw: {runs: [c_l], sweep: [c_l]}}
comparisons: {windows: {methods: [raw]}}
END
snakefile=$PWD/scripts/workflow/Snakefile profile=$PWD/scripts/workflow/slurm
cd "$at"
snakemake -s "$snakefile" --profile "$profile" --latency-wait 5 \
  --config experiments="$at/experiments.yaml" out=out
ls -l out/index.html
[[ $(scontrol -o show jobs | grep -c "JobName=vpr-.* JobState=COMPLETED") -ge 8 ]]

echo; echo "== status of jobs"
done_job=$(sbatch --parsable --mem=100 --output=/dev/null --wrap true)
gone_job=$(sbatch --parsable --mem=100 --output=/dev/null --wrap "sleep 600")
until [[ $("$profile/status.sh" "$done_job") == success ]]; do sleep 1; done
[[ $("$profile/status.sh" "$gone_job") == running ]]
scancel "$gone_job"
for job in "$gone_job" "$late_job"; do
  until [[ $("$profile/status.sh" "$job") == failed ]]; do sleep 1; done
  scontrol -o show job "$job" | grep -o "JobState=[A-Z]*"
done
echo "try.sh: all done"

#!/usr/bin/env bash
# The status of a job in Snakemake's terms:   status.sh JOB
# A killed job (memory, time, node) leaves no file; Slurm's controller knows its state, for a few
# minutes without accounting.
state=$(scontrol show job "$1" 2>/dev/null | sed -n 's/.*JobState=\([A-Z_]*\).*/\1/p')
[[ -n $state ]] || state=$(sacct -j "$1" -X -n -o State 2>/dev/null | awk '{print $1; exit}')
case $state in
  COMPLETED) echo success ;;
  BOOT_FAIL | CANCELLED* | DEADLINE | FAILED | NODE_FAIL) echo failed ;;
  OUT_OF_MEMORY | PREEMPTED | TIMEOUT) echo failed ;;
  *) echo running ;;
esac

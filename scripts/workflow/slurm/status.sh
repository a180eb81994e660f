#!/usr/bin/env bash
# What has become of a job, as Snakemake asks it:   status.sh JOB
# A job that was killed (memory, time, node) leaves no file that says so; Slurm's controller knows,
# for some minutes without accounting.
state=$(scontrol show job "$1" 2>/dev/null | sed -n 's/.*JobState=\([A-Z_]*\).*/\1/p')
[[ -n $state ]] || state=$(sacct -j "$1" -X -n -o State 2>/dev/null | awk '{print $1; exit}')
case $state in
  COMPLETED) echo success ;;
  BOOT_FAIL | CANCELLED* | DEADLINE | FAILED | NODE_FAIL) echo failed ;;
  OUT_OF_MEMORY | PREEMPTED | TIMEOUT) echo failed ;;
  *) echo running ;;
esac

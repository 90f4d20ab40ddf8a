#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Reports the state of a job to Snakemake: running, success or failed.
# usage: status.sh JOB
set -uo pipefail
said=$(scontrol --oneliner show job "$1" 2>&1) || case $said in
  *"Invalid job id"*) # the job ended long ago; only accounting (sacct), if any, knows the result
    said="JobState=$(sacct -X -n -P -o State -j "$1" 2>/dev/null | head -n 1 | cut -d' ' -f1)" ;;
  *) echo running; exit 0 ;; # slurmctld does not answer: ask again
esac
state=$(sed -nE 's/.*JobState=([A-Z_]*).*/\1/p' <<<"$said")
case $state in
  COMPLETED) echo success ;;
  PENDING | CONFIGURING | RUNNING | COMPLETING | SUSPENDED | REQUEUED | REQUEUE_HOLD | RESIZING | SIGNALING | STAGE_OUT | STOPPED) echo running ;;
  *) echo failed ;;
esac

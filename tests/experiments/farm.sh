#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A season as a farm: blocks, dates and robots of short simulated drives, some logs damaged, one of
# another block, one rig wrong. Runs it once in peace; once killed five times (SIGKILL, every second
# time the engine alone) and resumed; once by a Slurm of one node and two queues, which kills jobs that
# ask for too little memory, whose node is drained and one of whose jobs is cancelled on the way; and
# compares every byte of the results. Then adds one
# log and counts what is made. Prints what was set aside, times, and the cost per step beside that of
# the bare commands. Slurm's part needs root and Debian's slurmctld, slurmd, slurm-client and munge; all
# runs in a private network namespace.
#
# usage: tests/experiments/farm.sh [BLOCKS [DATES [ROBOTS]]]     (default 24 3 2: some 25 minutes of one core)
#   KILLS=N    times that it is killed (default 5)
#   SLURM=no   without Slurm's part
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
if [ -z "${FARM_INSIDE:-}" ]; then
  FARM_INSIDE=yes exec tests/system/in_namespace.sh "$0" "$@"
fi
export PATH=$PATH:/usr/sbin
orchard=${BUILD:-$PWD/build}/bin/orchard
work=$(mktemp -d)
slurm_pids=()
. tests/system/farm/season.sh
. tests/system/farm/slurm.sh
trap '[ ${#slurm_pids[@]} = 0 ] || stop_slurm; rm -rf "$work"' EXIT
blocks=${1:-24}
dates=${2:-3}
robots=${3:-2}
kills=${KILLS:-5}
farm=$work/peace
farm_rigs .
make_season "$farm" "$blocks" "$dates" "$robots"
cp -r "$farm" "$work/killed"
cp -r "$farm" "$work/slurm"

took() { awk -v a="$1" -v b="$(date +%s.%N)" 'BEGIN { printf "%.0f s", b - a }'; }

start=$(date +%s.%N)
"$orchard" farm run "$farm" --cores 2
echo "in peace: $(took "$start"); the steps' own: $(cd "$farm" && awk '{ w += $2; c += $3 } END { printf "%.0f s one after the other, %.0f s of processor", w, c }' work/costs.txt)"
steps=$(num_made "$farm")

start=$(date +%s.%N)
for k in $(seq "$kills"); do
  run_and_kill "$work/killed" $((steps * k / (kills + 1))) "$([ $((k % 2)) = 1 ] && echo all || echo engine)"
  echo "killed with $(num_made "$work/killed") of $steps results there"
done
"$orchard" farm run "$work/killed" --cores 2 | head -n 1
echo "killed $kills times: $(took "$start")"
if [ "$(digest_of "$farm")" = "$(digest_of "$work/killed")" ]; then echo "the same bytes"; else
  echo "OTHER BYTES"; diff -rq "$farm/results" "$work/killed/results"; fi

if [ "${SLURM:-yes}" = yes ] && has_slurm; then
  start_slurm "$work/cluster"
  profile=$work/slurm/profiles/slurm/config.yaml
  cp "$profile" "$work/config.yaml"
  sed -i -e 's/--mem={resources.mem_mb}/--mem=30/' -e 's/^retries:.*/retries: 0/' "$profile"
  "$orchard" farm run "$work/slurm" --profile slurm --cores 8 >"$work/said" 2>&1 &&
    echo "jobs with too little memory were not killed"
  named=$("$orchard" farm status "$work/slurm" | grep -c '^failed.*memory limit' || true)
  echo "jobs of 30 MB: $(grep -l 'exceeded memory limit' "$work"/slurm/work/slurm/*.txt | wc -l) killed for memory, $named steps named for it by farm status, $(num_made "$work/slurm") results there"
  cp "$work/config.yaml" "$profile"
  start=$(date +%s.%N)
  "$orchard" farm run "$work/slurm" --profile slurm --cores 8 >"$work/said" 2>&1 &
  pid=$!
  wait_until 3600 has_made "$work/slurm" $((steps / 4)) $pid
  job=
  wait_until 60 eval 'job=$(squeue -h -t RUNNING -o %A | head -n 1); [ -n "$job" ]'
  scancel "$job"
  echo "job $job cancelled with $(num_made "$work/slurm") results there"
  wait_until 3600 has_made "$work/slurm" $((steps / 2)) $pid
  scontrol update NodeName="$(hostname -s)" State=DRAIN Reason=test
  wait_until 120 eval '[ -z "$(squeue -h -t RUNNING)" ]'
  echo "node drained with $(num_made "$work/slurm") results there: $(squeue -h -t PENDING | wc -l) jobs wait"
  scontrol update NodeName="$(hostname -s)" State=RESUME
  wait $pid && echo "Slurm ended well" || { echo "Slurm's run failed"; tail -n 40 "$work/slurm/work/snakemake.txt"; }
  echo "by Slurm: $(took "$start"), $(head -n 1 "$work/said"); of the queues short and long: $(grep -c 'queue=short' "$work/slurm/work/snakemake.txt") and $(grep -c 'queue=long' "$work/slurm/work/snakemake.txt" || true)"
  if [ "$(digest_of "$farm")" = "$(digest_of "$work/slurm")" ]; then echo "the same bytes"; else
    echo "OTHER BYTES"; diff -rq "$farm/results" "$work/slurm/results"; fi
fi

sed 's/rate_hz: 6.8/rate_hz: 7.3/' "$work/rig_1_2.yaml" >"$work/rig_1_late.yaml"
drive 2 1 late "$work/more.lcm"
add "$work/more.lcm" 2 1 late
echo "one more log of a block's first date: $("$orchard" farm run "$farm" --cores 2 | head -n 1) of $(num_made "$farm") (its map, $dates dates and their reports, $((dates - 1)) comparisons)"

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Maps the same logs with `orchard map --jobs` 1, 2 and 4, in turn: one SHA-256 of map.csv, derived.lcm
# and trajectory.csv whatever the number of jobs, else exit 1. Prints the shortest time of each and
# how many times as fast as one job that is; on a machine that does nothing else it says something.
#   tests/experiments/jobs.sh [--build DIR] [--rounds N] [--short]
#     --build DIR  build folder (default build)
#     --rounds N   times that each is mapped (default 3)
#     --short      short drives, one round, no times
# Pullally needs its recording in $ORCHARD_DATA, or in shared/data beside this checkout.
set -euo pipefail
known_options="--build --rounds --short"
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
build=build rounds=3 short=no
while [ $# -gt 0 ]; do
  case $1 in
    --build) build=${2:?--build needs a folder}; shift ;;
    --rounds) rounds=${2:?--rounds needs a number}; shift ;;
    --short) short=yes; rounds=1 ;;
    *) echo "jobs: unknown option $1; see $0 --help" >&2; exit 2 ;;
  esac
  shift
done
orchard=$build/bin/orchard
data=${ORCHARD_DATA:-../shared/data}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

seconds=0  # the whole scene
[ $short = no ] || seconds=10
simulate() { # SCENE RIG [RIG_FILE]
  "$orchard" simulate --scene "$1" --seed 1 --config "config/$2.yaml" --duration $seconds \
    --out "$out/$2.lcm" >/dev/null
}
simulate tubes tubes
simulate orchard orchard
simulate orchard orchard_hard
scenes="tubes orchard orchard_hard"
if [ $short = no ]; then # pictures four times as large, as many cameras give them
  sed -e 's/width_px: 320/width_px: 640/' -e 's/height_px: 240/height_px: 480/' \
    -e 's/fc_px: \[221.5, 221.9\]/fc_px: [443.0, 443.8]/' \
    -e 's/cc_px: \[161.3, 118.2\]/cc_px: [323.1, 236.9]/' config/orchard_hard.yaml \
    >"$out/large.yaml"
  "$orchard" simulate --scene orchard --seed 1 --config "$out/large.yaml" --out "$out/large.lcm" \
    >/dev/null
  scenes="$scenes large"
fi
if [ $short = yes ]; then
  :  # its scans take long to match
elif [ -d "$data/pullally_drive_1" ]; then
  "$orchard" import "$data/pullally_drive_1" --out "$out/pullally.lcm" >/dev/null
  scenes="$scenes pullally"
else
  echo "skipped: pullally (no $data/pullally_drive_1)"
fi

num_different=0
for scene in $scenes; do
  config=config/$scene.yaml
  [ "$scene" != large ] || config=$out/large.yaml
  jobs_list="1 2 4"
  declare -A best=()
  for ((round = 0; round < rounds; ++round)); do
    for jobs in $jobs_list; do
      begin=$(date +%s%N)
      "$orchard" map "$out/$scene.lcm" --config "$config" --out "$out/map" --quiet --jobs "$jobs" \
        2>/dev/null
      took=$((($(date +%s%N) - begin) / 1000000))
      [ -n "${best[$jobs]:-}" ] && [ "${best[$jobs]}" -le $took ] || best[$jobs]=$took
      sum=$(cd "$out/map" && cat map.csv derived.lcm trajectory.csv | sha256sum | cut -c1-64)
      [ -e "$out/$scene.sum" ] || echo "$sum" >"$out/$scene.sum"
      if [ "$sum" != "$(cat "$out/$scene.sum")" ]; then
        echo "DIFFERENT: $scene with --jobs $jobs"
        num_different=$((num_different + 1))
      fi
      rm -rf "$out/map"
    done
  done
  line="$scene: --jobs ${jobs_list// /, }: $(cut -c1-16 "$out/$scene.sum")"
  if [ $short = no ]; then
    for jobs in $jobs_list; do
      line="$line, $jobs: ${best[$jobs]} ms ($(awk "BEGIN {printf \"%.2f\", ${best[1]} / ${best[$jobs]}}"))"
    done
  fi
  echo "$line"
done
[ $num_different -eq 0 ] || { echo "jobs: $num_different runs DIFFER" >&2; exit 1; }
echo SAME

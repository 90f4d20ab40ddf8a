#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# How well changes between two days are found: maps the simulated block before and after five
# percent of its trees were replaced, and twice unchanged, compares, and scores against the truth.
# The later drive scans at another rate, so that its noise is its own.
#
# usage: [MODE=slam] scripts/map_changes.sh [FIRST_SEED [LAST_SEED]]     (default 1 1)
#   MODE=fixes  places the robot by POSE_FIX (default); slam: by wheels and trunks, each map in a
#               frame of its own
set -euo pipefail
cd "$(dirname "$0")/.."
orchard=${BUILD:-$PWD/build}/bin/orchard
mode=${MODE:-fixes}
first=${1:-1}
last=${2:-$first}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

sed -e "s/mode: slam/mode: $mode/" -e 's/laps: 3/laps: 1/' -e 's/fix_rate_hz: 0/fix_rate_hz: 10/' \
  config/block.yaml >"$work/before.yaml"
grep -q "mode: $mode" "$work/before.yaml" || { echo "config/block.yaml has another pose.mode"; exit 1; }
sed 's/^\( *\)range_max_m: 20.0$/&\n\1rate_hz: 9.0/' "$work/before.yaml" >"$work/same.yaml"
{ cat "$work/same.yaml"; printf '  change:\n    fraction: 0.05\n'; } >"$work/changed.yaml"

for seed in $(seq "$first" "$last"); do
  for drive in before same changed; do
    "$orchard" simulate --scene orchard --seed "$seed" --out "$work/$drive.lcm" \
      --truth "$work/$drive.csv" --poses "$work/$drive.poses.csv" --config "$work/$drive.yaml" >/dev/null
    "$orchard" map "$work/$drive.lcm" --config "$work/$drive.yaml" --out "$work/$drive" --quiet
    rm "$work/$drive.lcm"
  done
  for later in changed same; do
    "$orchard" compare "$work/before" "$work/$later" --out "$work/compared" >/dev/null
    echo -n "seed $seed, $later: "
    # with fixes the map's frame is the truth's, and the first heading is not yet known well
    frame=$work/before.poses.csv
    [ "$mode" = fixes ] || frame=$work/before/trajectory.csv
    awk -f scripts/map_changes.awk "$work/before.poses.csv" "$frame" \
      "$work/before.csv" "$work/$later.csv" "$work/compared/compare.csv"
  done
done

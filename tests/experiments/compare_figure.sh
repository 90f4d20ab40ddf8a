#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Draws the comparison that README.md shows: a small simulated block, and the same a year later with
# 5 % of its trees felled (and as many planted), 5 % moved and 5 % grown. Some 10 s.
#   tests/experiments/compare_figure.sh [SEED]     (default 1; BUILD=folder)
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
orchard=${BUILD:-build}/bin/orchard seed=${1:-1} out=out/compare_figure
mkdir -p "$out"

sed -e 's/mode: slam/mode: fixes/' -e 's/laps: 3/laps: 1/' -e 's/fix_rate_hz: 0/fix_rate_hz: 10/' \
  -e 's/num_rows: 10/num_rows: 9/' -e 's/trees_per_row: 30/trees_per_row: 10/' \
  config/block.yaml >"$out/before.yaml"
# another rate, so that the later drive's noise is its own
sed 's/^\( *\)range_max_m: 20.0$/&\n\1rate_hz: 9.0/' "$out/before.yaml" >"$out/after.yaml"
printf '  change:\n    %s: 0.05\n    %s: 0.05\n    %s: 0.05\n    moved_m: 0.5\n    moved_spread_m: 1.0\n    growth_m: 0.04\n' \
  fraction moved_fraction grown_fraction >>"$out/after.yaml"

previous=()
for drive in before after; do
  "$orchard" simulate --scene orchard --seed "$seed" --out "$out/$drive.lcm" \
    --truth "$out/$drive.csv" --config "$out/$drive.yaml" >/dev/null
  "$orchard" map "$out/$drive.lcm" --config "$out/$drive.yaml" --out "$out/$drive" --quiet \
    "${previous[@]}"
  previous=(--previous "$out/before")
done
"$orchard" compare "$out/before" "$out/after" --out "$out/changes"

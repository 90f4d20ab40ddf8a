#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Is every way of graph.json free, over seeds 1-20 (or FIRST LAST) of the simulated orchard and in the
# real drives that are at hand? Against every landmark's rim, against what truly stands there, and of the
# real ones against the beams of their scans (tests/system/free_ways/check_ways.py). The robot has no
# camera here: a laser alone takes most for trees.
#   RIG=config/orchard.yaml  SECONDS_PER_DRIVE=90  OUT=out/free_ways  BUILD=build  DATA=../shared/data
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
orchard=${BUILD:-build}/bin/orchard
out=${OUT:-out/free_ways} data=${DATA:-../shared/data}
check=tests/system/free_ways/check_ways.py
mkdir -p "$out"
sed -e '/^camera:/,/^detector:/s/enabled: true/enabled: false/' \
  -e 's/^  use_odometry: true.*/  tree_threshold: 0.1/' "${RIG:-config/orchard.yaml}" >"$out/rig.yaml"
for seed in $(seq "${1:-1}" "${2:-20}"); do
  stem=$out/$seed
  "$orchard" simulate --scene orchard --seed "$seed" --config "$out/rig.yaml" \
    --duration "${SECONDS_PER_DRIVE:-90}" --out "$stem.lcm" --truth "$stem.csv" >/dev/null
  "$orchard" map "$stem.lcm" --config "$out/rig.yaml" --out "$stem" --quiet --no-derived
  echo "seed $seed: $(python3 "$check" "$stem" --truth "$stem.csv" || true)"
  rm "$stem.lcm"
done | tee "$out/table.txt"
for drive in "$data"/pullally_drive_*; do
  [ -d "$drive" ] || continue
  name=$(basename "$drive")
  "$orchard" import "$drive" --out "$out/$name.lcm" >/dev/null
  "$orchard" map "$out/$name.lcm" --config config/pullally.yaml --out "$out/$name" --quiet --no-derived
  echo "$name: $(python3 "$check" "$out/$name" --recording "$drive" || true)"
done | tee -a "$out/table.txt"

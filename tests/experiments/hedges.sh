#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Is a hedge one line? Over seeds 1-10 (or FIRST LAST) the first 300 s of the yard, poses by fixes: the
# hedge of 46 m beside the block, along x = 21 from y = 16 to 62. Prints the lines that lie along it,
# how long they are, and landmarks left on it.
#   OUT=out/hedges  BUILD=build
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
orchard=${BUILD:-build}/bin/orchard
out=${OUT:-out/hedges}
mkdir -p "$out"
sed -e 's/mode: slam/mode: fixes/' -e 's/fix_rate_hz: 0/fix_rate_hz: 10/' config/yard.yaml >"$out/rig.yaml"
for seed in $(seq "${1:-1}" "${2:-10}"); do
  stem=$out/$seed
  if [ ! -s "$stem.lcm" ]; then
    nice -n 10 "$orchard" simulate --scene yard --seed "$seed" --config "$out/rig.yaml" \
      --duration 300 --out "$stem.part.lcm" --truth "$stem.truth.csv" >/dev/null
    mv "$stem.part.lcm" "$stem.lcm"
  fi
  nice -n 10 "$orchard" map "$stem.lcm" --config "$out/rig.yaml" --out "$stem" --quiet
  awk -F, -v seed="$seed" '
    NR == 1 || $3 < 20 || $3 > 22 || $4 < 15 || $4 > 63 { next }
    $14 > 0 { lines = lines sprintf(" %.1f", $14); n++; next }
    { left++ }
    END { printf "seed %d: %d lines (%s m), %d landmarks of its own\n", seed, n, lines, left }' "$stem/map.csv"
done | tee "$out/table.txt"

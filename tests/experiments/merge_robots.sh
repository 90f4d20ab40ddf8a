#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Three robots map parts of the simulated block: the first 45 % of the way, placed by POSE_FIX; from
# 35 to 75 %; from 65 % to the end; the last two by wheels and trunks alone, each in the frame it
# began in. Merges the maps and scores the whole against the truth: in the first robot's frame, and
# laid upon it as it fits best; ids of the first map must be where they were. Some 30 s of one core a
# seed.
#
# usage: tests/experiments/merge_robots.sh [FIRST_SEED [LAST_SEED]]     (default 1 1)
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
orchard=${BUILD:-$PWD/build}/bin/orchard
first=${1:-1}
last=${2:-$first}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

sed -e 's/laps: 3/laps: 1/' config/block.yaml >"$work/slam.yaml"
sed -e 's/mode: slam/mode: fixes/' -e 's/fix_rate_hz: 0/fix_rate_hz: 10/' "$work/slam.yaml" \
  >"$work/fixes.yaml"

# robot NUMBER FROM_PERCENT TO_PERCENT MODE
robot() {
  "$orchard" simulate --scene orchard --seed "$seed" --config "$work/$4.yaml" \
    --out "$work/$1.lcm" --from $((way_s * $2 / 100)) --duration $((way_s * ($3 - $2) / 100)) >/dev/null
  "$orchard" map "$work/$1.lcm" --config "$work/$4.yaml" --out "$work/$1" --quiet
  rm "$work/$1.lcm"
}

for seed in $(seq "$first" "$last"); do
  "$orchard" simulate --scene orchard --seed "$seed" --config "$work/fixes.yaml" --duration 1 \
    --out "$work/begin.lcm" --truth "$work/truth.csv" >/dev/null
  way_s=$("$orchard" simulate --scene orchard --seed "$seed" --config "$work/fixes.yaml" \
    --from 1e9 --out "$work/none.lcm" 2>&1 | sed -n 's/.*the end of scene [a-z]* at \([0-9]*\).*/\1/p' || true)
  robot 1 0 45 fixes
  robot 2 35 75 slam
  robot 3 65 100 slam
  echo "seed $seed:"
  "$orchard" merge "$work"/{1,2,3} --any-place --out "$work/whole" | sed -e "s|$work/||g" -e 's/^/  /' || continue
  for aligned in "" --align; do
    "$orchard" evaluate "$work/whole" --truth "$work/truth.csv" $aligned >"$work/judged"
    grep -E '^(found|error against)' "$work/judged" | sed "s/^/  ${aligned:+aligned: }/"
    echo "  extra landmarks: $(grep -c '^extra.*(tree' "$work/judged" || true) trees, $(grep -c '^extra.*(object' "$work/judged" || true) others"
  done
  awk -F, 'FNR == 1 { file++; next } file == 1 { x[$1] = $3; y[$1] = $4; next }
    $1 in x { n++; if (($3 - x[$1]) ^ 2 + ($4 - y[$1]) ^ 2 < 0.04) kept++; delete x[$1] }
    END { for (id in x) lost++
      printf "  ids of the first map: %d within 0.2 m of where they were, %d elsewhere, %d lost\n", kept, n - kept, lost }' \
    "$work/1/map.csv" "$work/whole/map.csv"
done

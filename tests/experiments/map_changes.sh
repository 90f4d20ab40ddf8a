#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# How well changes between two days are found, and whether ids and numbers stay: maps the simulated
# block before and after five percent of its trees were felled (and as many planted in empty places),
# five percent moved by 0.5 to 1.5 m, five percent grew 20 to 60 mm wider (two standard deviations)
# and a tenth of posts and bushes came and went; and twice unchanged. Compares, scores against the
# truth by kind, and counts ids and numbers that `orchard map --previous` gave otherwise than before.
# The later drive scans at another rate, so that its noise is its own. Some 20 s of one core a seed.
#
# usage: [MODE=slam] [KINDS=replaced|grown] tests/experiments/map_changes.sh [FIRST_SEED [LAST_SEED]]  (default 1 1)
#   MODE=fixes      places the robot by POSE_FIX (default); slam: by wheels and trunks, each map in a
#                   frame of its own
#   KINDS=replaced  only fells and plants
#   KINDS=grown     only lets a third of the trees grow by 10 mm (sd 2.5), each day of three laps, and
#                   prints how well growth is known, and could be (growth_bound.py); fixes only
#   VERBOSE=1       says which claims are false and which changes were not found
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
orchard=${BUILD:-$PWD/build}/bin/orchard
mode=${MODE:-fixes}
first=${1:-1}
last=${2:-$first}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
exec 3>/dev/null
[ -z "${VERBOSE:-}" ] || exec 3>&2

kinds=${KINDS:-all}
laps=1
[ "$kinds" != grown ] || laps=3
sed -e "s/mode: slam/mode: $mode/" -e "s/laps: 3/laps: $laps/" -e 's/fix_rate_hz: 0/fix_rate_hz: 10/' \
  config/block.yaml >"$work/before.yaml"
grep -q "mode: $mode" "$work/before.yaml" || { echo "config/block.yaml has another pose.mode"; exit 1; }
sed 's/^\( *\)range_max_m: 20.0$/&\n\1rate_hz: 9.0/' "$work/before.yaml" >"$work/same.yaml"
{
  cat "$work/same.yaml"
  printf '  change:\n'
  [ "$kinds" = grown ] || printf '    fraction: 0.05\n'
  [ "$kinds" != grown ] || printf '    growth_m: 0.010\n    grown_fraction: 0.3333\n'
  [ "$kinds" != all ] || printf '    %s\n' 'moved_fraction: 0.05' 'moved_m: 0.5' \
    'moved_spread_m: 1.0' 'growth_m: 0.04' 'grown_fraction: 0.05' 'objects_fraction: 0.1'
} >"$work/changed.yaml"

# Where the first pose of a drive lies in its map: with fixes the map's frame is the truth's, and the
# first heading is not yet known well.
frame_of() {
  if [ "$mode" = fixes ]; then echo "$work/$1.poses.csv"; else echo "$work/$1/trajectory.csv"; fi
}

for seed in $(seq "$first" "$last"); do
  for drive in before same changed; do
    [ "$kinds" != grown ] || "${BUILD:-build}/experiments/true_observations" --scene orchard --seed "$seed" \
      --config "$work/$drive.yaml" --out "$work/$drive.looks.csv" >/dev/null
    "$orchard" simulate --scene orchard --seed "$seed" --out "$work/$drive.lcm" \
      --truth "$work/$drive.csv" --poses "$work/$drive.poses.csv" --config "$work/$drive.yaml" >/dev/null
    known=()
    [ "$drive" != changed ] || known=(--previous "$work/before")
    "$orchard" map "$work/$drive.lcm" --config "$work/$drive.yaml" --out "$work/$drive" --quiet \
      "${known[@]}"
    rm "$work/$drive.lcm"
  done
  for later in changed same; do
    "$orchard" compare "$work/before" "$work/$later" --out "$work/compared" >/dev/null
    awk -f tests/experiments/map_changes.awk "$work/before.poses.csv" "$(frame_of before)" \
      "$work/before.csv" "$work/$later.csv" "$work/compared/compare.csv" 2>&3 >"$work/seed"
    sed "s/^/$later,/" "$work/seed" >>"$work/scores"
    echo "seed $seed, $later: $(awk -F, '$1 == "truth" { t += $3 } $1 == "claim" { n[$4]++ }
      END { printf "%d true changes, %d found, %d false, %d of posts and bushes", t, n["right"],
        n["false"], n["object"] }' "$work/seed")"
  done
  [ "$kinds" != grown ] ||
    tests/experiments/growth_bound.py "$work/before" "$work/changed" >>"$work/scores"
  awk -f tests/experiments/map_ids.awk "$work/before.poses.csv" "$(frame_of before)" \
    "$work/changed.poses.csv" "$(frame_of changed)" "$work/before.csv" "$work/changed.csv" \
    "$work/before/map.csv" "$work/changed/map.csv" 2>&3 | tee -a "$work/scores" |
    awk -F, '{ printf "  ids: %d pairs, %d with another id, %d with another number, %d reused\n", $2, $3, $4, $5 }'
done

awk -F, '
  $1 == "ids" { pairs += $2; ids += $3; numbers += $4; reused += $5; next }
  $1 == "growth" { trees += $2; errors += $3; squares += $4; bounds += $5; next }
  $2 == "compared" { compared[$1] += $3 }
  $1 == "same" && $2 == "claim" { same++ }
  $1 == "changed" && $2 == "truth" { t[$3] += $4 }
  $1 == "changed" && $2 == "claim" {
    n[$3, $5]++
    bin = $4 < 0.8 ? 0 : $4 < 0.9 ? 1 : $4 < 0.99 ? 2 : 3
    claims[bin]++; sum[bin] += $4; right[bin] += $5 != "false"
  }
  END {
    print "kind      true  right  false  precision  recall   (wanted 0.95)"
    split("missing new moved grown thinner", kinds, " ")
    for (k = 1; k <= 5; k++) {
      kind = kinds[k]; r = n[kind, "right"] + 0; f = n[kind, "false"] + 0
      printf "%-8s %5d  %5d  %5d  %9s  %6s\n", kind, t[kind], r, f,
        r + f ? sprintf("%.3f", r / (r + f)) : "-", t[kind] ? sprintf("%.3f", r / t[kind]) : "-"
    }
    printf "unchanged: %d false of %d (%.2f %%, wanted 1 %%)\n", same, compared["same"],
      100 * same / compared["same"]
    print "confidence  claims  mean  right"
    split("below 0.8,0.8 to 0.9,0.9 to 0.99,0.99 to 1", names, ",")
    for (b = 0; b <= 3; b++) if (claims[b])
      printf "%-11s %6d  %.3f  %.3f\n", names[b + 1], claims[b], sum[b] / claims[b], right[b] / claims[b]
    printf "ids: of %d trees in both maps %d with another id, %d with another row or position; %d known ids given to new trees\n",
      pairs, ids, numbers, reused
    if (trees) printf "growth of %d trees: bias %.2f mm, RMS error %.2f mm, Cramer-Rao bound %.2f mm\n",
      trees, 1e3 * errors / trees, 1e3 * sqrt(squares / trees), 1e3 * sqrt(bounds / trees)
  }' "$work/scores"

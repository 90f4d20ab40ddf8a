#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A robot with one scanner that sees ahead, and the same robot with a second one that sees behind:
# trees found and the path's error of both maps, over seeds FIRST to LAST (1 3).
#   two_scanners.sh [FIRST [LAST]]
#   RIG=config/block.yaml  SECONDS_PER_DRIVE=600  BUILD=build  OUT=out/two_scanners
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
orchard=${BUILD:-build}/bin/orchard
rig=${RIG:-config/block.yaml}
out=${OUT:-out/two_scanners}
mkdir -p "$out"

# Both look over half a turn, so that neither sees what the other sees but at the sides.
one=$out/one.yaml two=$out/two.yaml
awk '{ print } /^  scanner:/ {
  print "    num_beams: 513\n    bearing_min_rad: -1.5707963267948966"
  print "    bearing_step_rad: 0.006135923151542565\n    rate_hz: 10.0\n    beam_period_us: 97.65625" }' \
  "$rig" >"$one"
{ cat "$one"
  printf 'laser_rear:\n  enabled: true\n  mount_x_m: -0.35\n  mount_yaw_rad: 3.141592653589793\n'
  awk '/^laser:/ { on = 1; next } /^[a-z]/ { on = 0 } on && /range_sd/' "$rig"; } >"$two"

# number JSON KEY [AFTER]: the first number of that key, behind the first line that has AFTER
number() {
  awk -v key="\"$2\":" -v after="${3:-}" '
    after != "" && index($0, "\"" after "\":") { seen = 1 }
    (after == "" || seen) && index($0, key) { sub(/.*: /, ""); sub(/,.*/, ""); print; exit }' "$1"
}

printf '%5s %-9s %7s %7s %7s %7s %9s %9s\n' seed scanners trees missed twice extra 'RMS (m)' 'path (m)'
for seed in $(seq "${1:-1}" "${2:-${1:-3}}"); do
  for kind in one two; do
    stem=$out/$seed-$kind
    "$orchard" simulate --scene orchard --seed "$seed" --config "$out/$kind.yaml" \
      --duration "${SECONDS_PER_DRIVE:-600}" --out "$stem.lcm" --truth "$stem.truth.csv" \
      --poses "$stem.poses.csv" >/dev/null
    "$orchard" map "$stem.lcm" --config "$out/$kind.yaml" --out "$stem" --quiet
    "$orchard" evaluate map "$stem" --truth "$stem.truth.csv" --poses "$stem.poses.csv" --align \
      --gate 0.3 --json >"$stem.map.json"
    "$orchard" evaluate trajectory "$stem" --truth "$stem.poses.csv" --align --json >"$stem.path.json"
    printf '%5s %-9s %7s %7s %7s %7s %9.4f %9.4f\n' "$seed" "$kind" \
      "$(number "$stem.map.json" num_trees)" "$(number "$stem.map.json" num_trees_missed)" \
      "$(number "$stem.map.json" num_duplicates)" "$(number "$stem.map.json" num_extra)" \
      "$(number "$stem.map.json" rms_m error_trees)" "$(number "$stem.path.json" rmse ape_position_m)"
  done
done

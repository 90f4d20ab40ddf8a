#!/usr/bin/env bash
# Maps the simulated yard over seeds 1-10 (or FIRST LAST) by wheels and trunks, and by scans and
# trunks without wheels, and prints the path's error after rigid alignment.
#   RIG=config/yard.yaml  BUILD=build  OUT=out/yard
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
orchard=${BUILD:-build}/bin/orchard
rig=${RIG:-config/yard.yaml}
out=${OUT:-out/yard}
mkdir -p "$out"
sed 's/^  mode: slam$/&\n  motion: scans/' "$rig" >"$out/scans.yaml"

# rmse MAP POSES: of the path's position [m]
rmse() {
  "$orchard" evaluate trajectory "$1" --truth "$2" --align --json |
    awk '/"ape_position_m":/ { seen = 1 } seen && /"rmse":/ { sub(/.*: /, ""); sub(/,.*/, ""); print; exit }'
}

printf '%5s %14s %14s\n' seed 'wheels (m)' 'scans (m)'
for seed in $(seq "${1:-1}" "${2:-10}"); do
  stem=$out/$seed
  if [ ! -s "$stem.lcm" ]; then
    nice -n 15 "$orchard" simulate --scene yard --seed "$seed" --config "$rig" \
      --out "$stem.part.lcm" --truth "$stem.truth.csv" --poses "$stem.poses.csv" >/dev/null
    mv "$stem.part.lcm" "$stem.lcm"
  fi
  nice -n 15 "$orchard" map "$stem.lcm" --config "$rig" --out "$stem.wheels" --quiet >/dev/null 2>&1
  nice -n 15 "$orchard" map "$stem.lcm" --config "$out/scans.yaml" --out "$stem.scans" --quiet \
    >/dev/null 2>&1
  printf '%5d %14.3f %14.3f\n' "$seed" "$(rmse "$stem.wheels" "$stem.poses.csv")" \
    "$(rmse "$stem.scans" "$stem.poses.csv")"
done | tee "$out/table.txt"

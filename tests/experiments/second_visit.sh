#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Two drives of one real orchard, in which nothing changed between them: each is mapped, and mapped
# with the other's ids and placed in the other's map by its laser alone. Prints where and how well it
# is placed, what compare claims, and what ids and numbers clear trees keep. The recordings are not
# part of the repository.
#   tests/experiments/second_visit.sh [FOLDER]   the folder of recordings (default ../shared/data)
# BUILD=DIR uses another build folder than build/.
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
data=${1:-../shared/data}
[ -d "$data/pullally_drive_2" ] || { echo "second_visit: no drives in $data" >&2; exit 3; }
orchard=${BUILD:-build}/bin/orchard
visit=${BUILD:-build}/experiments/second_visit
out=out/second_visit
mkdir -p "$out"
for drive in 1 2; do
  "$orchard" import "$data/pullally_drive_$drive" --out "$out/$drive.lcm" >/dev/null
  "$orchard" map "$out/$drive.lcm" --config config/pullally.yaml --out "$out/map_$drive" --quiet
done
for pair in "1 2" "2 1"; do
  read -r earlier later <<<"$pair"
  "$orchard" map "$out/$later.lcm" --config config/pullally.yaml --out "$out/kept_$later" --quiet \
    --previous "$out/map_$earlier"
  sed "s#^  mode: odometry\$#  mode: prior_map\n  prior_map:\n    map_file: $PWD/$out/map_$earlier#" \
    config/pullally_laser_only.yaml >"$out/placed.yaml"
  grep -q 'mode: prior_map' "$out/placed.yaml" || { echo "second_visit: another mode"; exit 1; }
  "$orchard" map "$out/$later.lcm" --config "$out/placed.yaml" --out "$out/placed_$later" --quiet
  echo "drive $later in the map of drive $earlier"
  "$visit" "$data/pullally_drive_$earlier" "$out/map_$earlier" "$out/map_$later" \
    "$out/kept_$later" "$out/placed_$later" | sed 's/^/  /'
done

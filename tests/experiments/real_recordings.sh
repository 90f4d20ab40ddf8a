#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Imports and maps every recording folder that is at hand and has a rig in config/; each map in
# out/real/NAME. Where trunks pile up in the raw scans is compared with the map of pullally; what
# koala saw last is laid upon what it saw first. The recordings are not part of the repository.
#   tests/experiments/real_recordings.sh [FOLDER]   the folder of recordings (default ../shared/data)
# BUILD=DIR uses another build folder than build/.
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
data=${1:-../shared/data}
[ -d "$data" ] || { echo "real_recordings: there is no folder $data" >&2; exit 3; }
orchard=${BUILD:-build}/bin/orchard
clear_trees=${BUILD:-build}/experiments/clear_trees  # built with the tests
return_of=${BUILD:-build}/experiments/return_trip  # the same
[ -x "$orchard" ] || scripts/build.sh

# The rig of urg_geometry_front is config/urg_geometry_front.yaml, urg_front.yaml,
# urg_geometry.yaml or urg.yaml.
rig_of() {
  local name=${1/_geometry/}
  for candidate in "$name" "${name%%_*}_${name##*_}" "${name%_*}" "${name%%_*}"; do
    [ ! -f "config/$candidate.yaml" ] || { echo "config/$candidate.yaml"; return; }
  done
}

mkdir -p out/real
for folder in "$data"/*/; do
  [ -f "$folder/sensors.yaml" ] || continue
  name=$(basename "$folder")
  rig=$(rig_of "$name")
  [ -n "$rig" ] || { echo "$name: no rig in config/"; continue; }
  "$orchard" import "$folder" --out "out/real/$name.lcm" >/dev/null
  echo "$name ($rig)"
  "$orchard" map "out/real/$name.lcm" --config "$rig" --out "out/real/$name" |
    head -n 2 | sed 's/^/  /'
  case $name in
    pullally_*)
      [ -x "$clear_trees" ] || continue
      "$clear_trees" "$folder" "out/real/$name" | sed 's/^/  /'
      echo "$name (config/pullally_laser_only.yaml)"
      alone=out/real/${name}_laser_only
      "$orchard" map "out/real/$name.lcm" --config config/pullally_laser_only.yaml --out "$alone" |
        head -n 2 | sed 's/^/  /'
      "$clear_trees" "$folder" "$alone" "out/real/$name" | sed 's/^/  /'
      "$orchard" evaluate trajectory "$alone" --truth "$folder/poses.csv" --align |
        awk '/^APE position/ { print "  path from the recording'"'"'s own track: RMS " $5 " m, at most " $10 " m" }' ;;
    koala_*) [ ! -x "$return_of" ] || "$return_of" "$folder" "out/real/$name" "$rig" | sed 's/^/  /' ;;
  esac
done | tee out/real/summary.txt

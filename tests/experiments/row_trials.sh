#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Does finding rows depend on chance? Two figures, some ten seconds of one core besides the maps:
# Pullally's drives, with the track and by the laser alone, each map perturbed SEEDS times (every tree
# displaced by its standard error and 3 cm, its number of observations Poisson-distributed, so that
# landmarks come and go): how many of these maps have the five rows 4.3 m apart and no others; and
# random blocks, straight or curved, with bushes at the ends of the rows and hedges across and along
# them: how many have the rows that were planted. Seeds above 1000 are for choosing.
#   tests/experiments/row_trials.sh [SEEDS [FIRST LAST]]   (default 500, and blocks 1 to 500)
# BUILD=DIR uses another build folder than build/, OUT=DIR another place than out/rows.
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
build=${BUILD:-build}
out=${OUT:-out/rows}
mkdir -p "$out"
for drive in 1 2; do
  recording=../shared/data/pullally_drive_$drive
  [ -d "$recording" ] || { echo "row_trials: there is no folder $recording, passed over"; continue; }
  "$build/bin/orchard" import "$recording" --out "$out/$drive.lcm" >/dev/null
  for rig in pullally pullally_laser_only; do
    # landmarks of few observations too: another drive may see them more often
    sed 's/^  min_observations: 5$/  min_observations: 2/' "config/$rig.yaml" >"$out/$rig.yaml"
    "$build/bin/orchard" map "$out/$drive.lcm" --config "$out/$rig.yaml" --out "$out/${drive}_$rig" \
      >/dev/null
    echo "drive $drive, $rig: $("$build/experiments/row_trials" map "$out/${drive}_$rig/map.csv" 5 4.3 "${1:-500}")"
  done
done
"$build/experiments/row_trials" planted "${2:-1}" "${3:-500}"

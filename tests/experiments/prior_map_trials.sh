#!/usr/bin/env bash
# Localisation in a prior map over random blocks of 10 rows of 30 trees (4 m x 2.5 m, 8 % missing, 5 %
# changed since they were mapped), odometry 3 %, sightings of an URG-class scanner from geometry
# alone: global starts, blocks that are exact grids, maps of other blocks, robots carried to another
# alley, drives through all alleys. Seeds FIRST to LAST (1 to 800; those below are kept for reports,
# 1001 and above for choosing). Half an hour of one core. Needs a build in build/ (or BUILD=folder).
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
trials=${BUILD:-build}/experiments/prior_map_trials
first=${1:-1}
last=${2:-800}
drives=$((first + (last - first) / 20))   # a drive through a whole block is as long as 20 starts
mkdir -p out
{
  "$trials" global "$first" "$last"
  "$trials" regular "$first" "$drives"
  "$trials" foreign "$first" "$((first + (last - first) / 4))"
  "$trials" carried "$first" "$((first + (last - first) / 4))"
  "$trials" tracking "$first" "$drives"
} | tee out/prior_map_trials.txt

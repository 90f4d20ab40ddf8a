#!/usr/bin/env bash
# Prints how well calibrations of simulated rigs meet the truth, over seeds 1-50 (or those given:
# FIRST LAST), and how many of the stated 95 % intervals hold it. Needs a build in build/ (or
# BUILD=folder). The seeds were used for nothing else: no threshold was chosen on them.
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
build=${BUILD:-build}
mkdir -p out
{
  "$build/experiments/camera_seeds" "${1:-1}" "${2:-50}"
  # laser to camera: 20 views, one picture (pixels) and one scan of the URG each; with the ends of
  # the lines on the board's measured edges, and without
  "$build/experiments/laser_camera_seeds" "${1:-1}" "${2:-50}" 20 1 edges 2>/dev/null
  "$build/experiments/laser_camera_seeds" "${1:-1}" "${2:-50}" 20 1 no-edges 2>/dev/null
  # degenerate handling (1 parallel, 2 turned only, 3 leaned only, 4 two orientations, 5 still,
  # 6 small tilts): every seed must be refused
  for handling in 1 2 3 4 5 6; do
    "$build/experiments/laser_camera_seeds" "${1:-1}" "$((${1:-1} + 2))" 20 1 edges "$handling" 2>/dev/null |
      grep -v '^  '
  done
} | tee out/calibration_figures.txt

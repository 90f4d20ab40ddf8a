#!/usr/bin/env bash
# Prints how well calibrations of simulated rigs meet the truth, over seeds 1-50 (or those given:
# FIRST LAST), and how many of the stated 95 % intervals hold it. Needs a build in build/ (or
# BUILD=folder). The seeds were used for nothing else: no threshold was chosen on them.
set -euo pipefail
cd "$(dirname "$0")/.."
build=${BUILD:-build}
mkdir -p out
{
  "$build/bin/orchard_camera_seeds" "${1:-1}" "${2:-50}"
} | tee out/calibration_figures.txt

#!/usr/bin/env bash
# A robot that drives curves (1 m/s, 0.5 rad/s) past trees against one that stops for every scan, and
# the camera delays that are found, over seeds 1-10 (or those given: FIRST LAST). Positions come with
# 3 mm and 1 mrad of noise only, so that the pose hides nothing. Needs a build in build/ (or
# BUILD=folder).
set -euo pipefail
cd "$(dirname "$0")/.."
build=${BUILD:-build}
mkdir -p out
{
  status=0
  for what in map delay; do
    "$build/bin/orchard_moving_robot" config/orchard.yaml "$what" "${1:-1}" "${2:-10}" || status=1
  done
  exit "$status"
} | tee out/moving_robot.txt

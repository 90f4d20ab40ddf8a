#!/usr/bin/env bash
# A robot that drives curves (1 m/s, 0.5 rad/s) past trees against one that stops for every scan, and
# the camera delays that are found, over seeds 1-10 (or those given: FIRST LAST). A drive weaves
# between two rows of 12 trees, some 25 s; positions come with 3 mm and 1 mrad of noise only, so that
# the pose hides nothing. The two run beside each other. Needs a build in build/ (or BUILD=folder).
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
build=${BUILD:-build}
mkdir -p out
run() {
  "$build/experiments/moving_robot_seeds" config/orchard.yaml "$1" "${2:-1}" "${3:-10}" \
    > "out/moving_robot_$1.txt"
}
status=0
run delay "$@" &
delay_pid=$!
run map "$@" || status=1
wait "$delay_pid" || status=1
cat out/moving_robot_map.txt out/moving_robot_delay.txt | tee out/moving_robot.txt
rm out/moving_robot_map.txt out/moving_robot_delay.txt
exit "$status"

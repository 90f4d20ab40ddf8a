#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Shows which maps a change of the code changed: maps the same logs with the programs of revision REV
# and with those of this checkout, and compares map.csv, trajectory.csv and derived.lcm byte by byte.
# Prints one line per log, SAME or what differs; exits 1 when a byte differs.
#   tests/experiments/same_as.sh REV [--scenes LIST] [--rev-build DIR] [--build DIR]
#     REV              a commit of this repository
#     --scenes LIST    of tubes, orchard, orchard_hard, block, prior_map, pullally,
#                      pullally_laser_only, koala (default all; the last three need their recordings
#                      in $ORCHARD_DATA, or in shared/data beside this checkout)
#     --rev-build DIR  a build folder of REV that exists already (default: REV is built in
#                      out/same_as/REV)
#     --build DIR      the build folder of this checkout (default build), used as it is
set -euo pipefail
known_options="--scenes --rev-build --build"
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
fail() { echo "same_as: $*" >&2; exit 2; }

scenes=tubes,orchard,orchard_hard,block,prior_map,pullally,pullally_laser_only,koala
rev=
rev_build=
build_dir=build
while [ $# -gt 0 ]; do
  case $1 in
    --scenes) scenes=${2:?--scenes needs a list}; shift ;;
    --rev-build) rev_build=${2:?--rev-build needs a folder}; shift ;;
    --build) build_dir=${2:?--build needs a folder}; shift ;;
    -*) fail "unknown option $1; see $0 --help" ;;
    *) rev=$1 ;;
  esac
  shift
done
[ -n "$rev" ] || fail "which revision? see $0 --help"
rev=$(git rev-parse --verify --quiet "$rev^{commit}") || fail "there is no such revision"
new=$PWD/$build_dir/bin/orchard
[ -x "$new" ] || fail "$build_dir has no programs; run scripts/build.sh first"

out=$PWD/out/same_as
mkdir -p "$out"
if [ -z "$rev_build" ]; then
  tree=$out/$rev
  [ -d "$tree" ] || git worktree add --detach --quiet "$tree" "$rev"
  rev_build=$tree/build
  cmake -S "$tree" -B "$rev_build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DORCHARD_TESTS=OFF \
    -DORCHARD_BENCHMARKS=OFF >"$out/configure.log"
  ninja -C "$rev_build" orchard
fi
old=$(realpath "$rev_build")/bin/orchard
[ -x "$old" ] || fail "$rev_build has no programs"
# Each program reads the configuration of its own checkout.
old_config=$(dirname "$(realpath "$rev_build")")/config
new_config=$PWD/config
data=$(realpath "${ORCHARD_DATA:-../shared/data}" 2>/dev/null || echo none)

# simulate CONFIG ARGUMENTS...: with the old program, so that both sides map the same log.
simulate() {
  local config=$1
  shift
  "$old" simulate --config "$config" "$@" >/dev/null
}

# rows DIR MODE: block.yaml of the old checkout cut down to a few rows.
few_rows() {
  sed -e 's/num_rows: 10/num_rows: 4/' -e 's/trees_per_row: 30/trees_per_row: 14/' \
    -e 's/laps: 3/laps: 1/' "$1/block.yaml"
}

# second_day DIR: a rig that finds itself in the map of the first day.
second_day() {
  few_rows "$1" | sed -e "s|mode: slam|mode: prior_map\n  prior_map: {map_file: $out/day1}|"
  printf '  change: {fraction: 0.05}\n  carry: {at_s: 20, for_s: 3, to_alley: 3}\n'
}

num_different=0
for scene in ${scenes//,/ }; do
  log=$out/$scene.lcm
  old_rig=$old_config/$scene.yaml
  new_rig=$new_config/$scene.yaml
  recording=
  case $scene in
    tubes) simulate "$old_rig" --scene tubes --seed 1 --out "$log" ;;
    orchard | orchard_hard)
      simulate "$old_rig" --scene orchard --seed 1 --duration 60 --out "$log" ;;
    block) simulate "$old_rig" --scene orchard --seed 1002 --duration 300 --out "$log" ;;
    prior_map)
      few_rows "$old_config" | sed -e 's/mode: slam/mode: fixes/' -e 's/fix_rate_hz: 0/fix_rate_hz: 10/' \
        >"$out/day1.yaml"
      simulate "$out/day1.yaml" --scene orchard --seed 1001 --out "$out/day1.lcm"
      "$old" map "$out/day1.lcm" --config "$out/day1.yaml" --out "$out/day1" --quiet
      old_rig=$out/day2.old.yaml
      new_rig=$out/day2.new.yaml
      second_day "$old_config" >"$old_rig"
      second_day "$new_config" >"$new_rig"
      simulate "$old_rig" --scene orchard --seed 1001 --duration 45 --out "$log" ;;
    pullally | pullally_laser_only) recording=pullally_drive_1 ;;
    koala) recording=koala_poles ;;
    *) fail "there is no scene $scene" ;;
  esac
  if [ -n "$recording" ]; then
    if [ ! -d "$data/$recording" ]; then
      echo "$scene: SKIPPED: no $data/$recording"
      continue
    fi
    "$old" import "$data/$recording" --out "$log" >/dev/null
  fi
  rm -rf "$out/$scene.old" "$out/$scene.new"
  "$old" map "$log" --config "$old_rig" --out "$out/$scene.old" --quiet >/dev/null
  "$new" map "$log" --config "$new_rig" --out "$out/$scene.new" --quiet >/dev/null
  different=
  for file in map.csv trajectory.csv derived.lcm; do
    cmp -s "$out/$scene.old/$file" "$out/$scene.new/$file" || different+=" $file"
  done
  if [ -z "$different" ]; then
    echo "$scene: SAME"
  else
    num_different=$((num_different + 1))
    echo "$scene: DIFFERENT:$different (in $out/$scene.old and $out/$scene.new)"
  fi
done
[ $num_different -eq 0 ]

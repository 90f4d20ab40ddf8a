# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# To be sourced: a season of simulated drives as a farm, and what a killed run is compared by.
# $orchard is the program, $work a folder to write into.

# farm_rigs SOURCE: rigs of two robots on three dates, each of which scans at a rate of its own, so
# that its noise is its own; from the second date on five percent of the trees are gone.
farm_rigs() {
  sed -e 's/mode: slam/mode: fixes/' -e 's/laps: 3/laps: 1/' -e 's/fix_rate_hz: 0/fix_rate_hz: 10/' \
    -e 's/num_rows: 10/num_rows: 3/' -e 's/trees_per_row: 30/trees_per_row: 8/' \
    "$1/config/block.yaml" >"$work/rig.yaml"
  local date robot
  for date in 1 2 3; do
    for robot in 1 2; do
      sed "s/^\( *\)range_max_m: 20.0\$/&\n\1rate_hz: $((5 + date)).$((robot * 4))/" "$work/rig.yaml" \
        >"$work/rig_${date}_$robot.yaml"
      [ "$date" = 1 ] || printf '  change:\n    fraction: 0.05\n' >>"$work/rig_${date}_$robot.yaml"
    done
  done
}

# drive SEED DATE ROBOT LOG
drive() {
  "$orchard" simulate --scene orchard --seed "$1" --config "$work/rig_$2_$3.yaml" --out "$4" >/dev/null
}

# make_season FARM BLOCKS DATES ROBOTS: logs of every block, date and robot, and then what goes wrong:
# block 1, date 2: robot 1's log is cut in the middle; block 2, date 1: robot 2's is no log at all;
# block 3 (2, where there are two), date 2: robot 2 has driven block 1; block 1, date 2: a robot whose rig names a wrong mount.
make_season() {
  local farm=$1 block date robot
  "$orchard" farm init "$farm" >/dev/null
  for block in $(seq "$2"); do
    for date in $(seq "$3"); do
      for robot in $(seq "$4"); do
        drive "$block" "$date" "$robot" "$work/drive.lcm"
        add "$work/drive.lcm" "$block" "$date" "$robot"
      done
    done
  done
  local log=$farm/logs/block_1/2026-02-01/robot_1/drive.lcm
  truncate -s $(($(stat -c %s "$log") * 3 / 5)) "$log"
  head -c 20000 "$farm/logs/block_2/2026-01-01/robot_2/drive.lcm" | tr '\0-\377' '\1-\377\0' >"$work/junk"
  mv "$work/junk" "$farm/logs/block_2/2026-01-01/robot_2/drive.lcm"
  drive 1 2 2 "$farm/logs/block_$(($2 < 3 ? $2 : 3))/2026-02-01/robot_2/drive.lcm"
  drive 1 1 1 "$work/drive.lcm"
  add "$work/drive.lcm" 1 2 wrong
  sed 's/mount_x_m: 0.35/&\n  mount_yaw_rad: 1.2/' "$work/rig_1_1.yaml" >"$farm/rigs/robot_wrong.yaml"
}

# add LOG BLOCK DATE ROBOT, to $farm
add() {
  "$orchard" farm add "$farm" "$1" --block "block_$2" --date "2026-0$3-01" --robot "robot_$4" >/dev/null
}

num_made() { find "$1/results" -name state.txt 2>/dev/null | wc -l; }

# wait_until SECONDS COMMAND...: until it is true; false after so many seconds.
wait_until() {
  local end=$((SECONDS + $1))
  shift
  until "$@"; do
    [ $SECONDS -lt $end ] || return 1
    read -r -t 0.05 <> <(:) || true
  done
}

has_made() { [ "$(num_made "$1")" -ge "$2" ] || ! kill -0 "$3" 2>/dev/null; }

# run_and_kill FARM NUM MODE: a run that is killed (SIGKILL) once NUM results are there; MODE "all":
# with all that it has started; "engine": alone, so that its steps go on without it.
run_and_kill() {
  setsid "$orchard" farm run "$1" --cores 2 >/dev/null 2>&1 &
  local pid=$!
  wait_until 3600 has_made "$1" "$2" $pid || return 1
  if [ "$3" = all ]; then
    kill -KILL -- -$pid 2>/dev/null || true
  else
    pkill -KILL -P $pid 2>/dev/null || true
    kill -KILL $pid 2>/dev/null || true
  fi
  wait $pid 2>/dev/null || true
}

# digest_of FARM: of all results, names and bytes.
digest_of() { (cd "$1/results" && find . -type f ! -path './.*' -print0 | sort -z | xargs -0 sha256sum | sha256sum); }

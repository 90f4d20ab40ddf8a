#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The examples for a robot of one's own, built and run as their first lines say.
#   examples_test.sh BIN SOURCE_TREE
. "$(dirname "$0")/../bus/common.sh"
bin=$(realpath "$1")
source_tree=$2
command -v lcm-gen >/dev/null || { echo "skipped: no lcm-gen here"; exit 77; }
types=("$source_tree/lcmtypes/scan_t.lcm" "$source_tree/lcmtypes/odometry_t.lcm")
cd "$work"
cp "$source_tree"/scripts/examples/send.* .

# heard WHO: both channels arrive and pass the guard.
heard() {
  for channel in SCAN ODOMETRY; do
    timeout 60 "$bin/orchard" echo "$channel" --count 3 --json --lcm-url "$url" >"$channel.txt" 2>echo.err ||
      { cat echo.err "$1.log" >&2; fail "$1: no $channel"; }
  done
  grep -q '"bearing_step_rad":0.01,' SCAN.txt || { cat SCAN.txt >&2; fail "$1: another scan"; }
  grep -q '"speed_mps":0.5,' ODOMETRY.txt || { cat ODOMETRY.txt >&2; fail "$1: another speed"; }
  echo "ok: $1"
}

lcm-gen --cpp "${types[@]}"
"${CXX:-g++}" -std=c++17 -I. send.cpp -llcm -o send
start cpp.log ./send
cpp=$started
heard cpp
kill "$cpp"

if command -v python3 >/dev/null; then
  rm -rf orchard
  lcm-gen --python "${types[@]}"
  start python.log python3 send.py
  heard python
else
  echo "no python3 here: send.py was not tried"
fi

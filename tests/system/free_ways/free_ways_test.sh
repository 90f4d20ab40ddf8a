#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Is every way of graph.json free: in a simulated orchard against what truly stands there, in a real drive
# (where it is at hand) against the beams of the scans; and would a way into a tree be found? Both drives and
# twenty orchards: `experiment run free_ways`.
#   free_ways_test.sh ORCHARD SOURCE_TREE FOLDER_OF_RECORDINGS FOLDER_OF_map_pullally.sh
set -euo pipefail
orchard=$1 source=$2 recordings=$3 pullally=$4
check=$source/tests/system/free_ways/check_ways.py
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# without its camera a drive is simulated in a second
sed -e '/^camera:/,/^detector:/s/enabled: true/enabled: false/' \
  -e 's/^  use_odometry: true.*/  tree_threshold: 0.1/' "$source/config/orchard.yaml" >"$work/rig.yaml"
"$orchard" simulate --scene orchard --seed 5 --config "$work/rig.yaml" --duration 90 \
  --out "$work/drive.lcm" --truth "$work/truth.csv" >/dev/null
"$orchard" map "$work/drive.lcm" --config "$work/rig.yaml" --out "$work/map" --quiet --no-derived
python3 "$check" "$work/map" --truth "$work/truth.csv" | tee "$work/said"
grep -q '^[1-9][0-9]* ways' "$work/said" || { echo 'no way was found'; exit 1; }

# a check that cannot fail checks nothing: the first way led to the first landmark
python3 - "$work/map" <<'PYTHON'
import csv, json, sys
graph = json.load(open(sys.argv[1] + '/graph.json'))
mark = next(csv.DictReader(open(sys.argv[1] + '/map.csv')))
graph['edges'][0]['line'].insert(1, [float(mark['x_m']), float(mark['y_m'])])
json.dump(graph, open(sys.argv[1] + '/graph.json', 'w'))
PYTHON
if python3 "$check" "$work/map" >/dev/null; then
  echo 'a way into a tree passed for free'
  exit 1
fi

drive=pullally_drive_1
if [ -d "$recordings/$drive" ]; then
  python3 "$check" "$pullally/map" --recording "$recordings/$drive"
else
  echo "$drive is not at hand"
fi

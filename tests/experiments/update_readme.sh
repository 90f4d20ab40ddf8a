#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Puts what the last scripts/demo.sh printed and drew into README.md: nothing there is typed.
set -euo pipefail
cd "$(dirname "$0")/../.."

tables=out/demo/tables.txt
[ -s $tables ] && [ -s out/demo/map.png ] || {
  echo "update_readme: no result of the demo; run scripts/demo.sh first" >&2
  exit 1
}

# insert NAME FILE: replaces what stands between the two marker lines of NAME by FILE, indented.
insert() {
  grep -q "^<!-- $1: " README.md && grep -q "^<!-- end of $1 -->" README.md || {
    echo "update_readme: README.md has lost its markers \"$1\"" >&2
    exit 1
  }
  awk -v name="$1" -v file="$2" '
    index($0, "<!-- " name ": ") == 1 {
      print; print "";
      while ((getline line < file) > 0) print (line == "" ? "" : "    " line);
      print ""; skip = 1; next
    }
    index($0, "<!-- end of " name " -->") == 1 { skip = 0 }
    !skip' README.md >README.md.new
  mv README.md.new README.md
}

# insert_if_made NAME FILE SCRIPT: the same where FILE is there; else says which script makes it.
insert_if_made() {
  if [ -s "$2" ]; then
    insert "$1" "$2"
  else
    echo "update_readme: \"$1\" left as it is ($3 was not run)"
  fi
}

insert "demo tables" $tables
mkdir -p scripts/figures
cp out/demo/map.png scripts/figures/demo_map.png

insert_if_made "tube seeds" out/tube_seeds.txt tests/experiments/tube_seeds.sh
insert_if_made "benchmarks" out/benchmark/summary.txt tests/benchmark/benchmark.sh
insert_if_made "real recordings" out/real/summary.txt tests/experiments/real_recordings.sh
if [ -s out/real/pullally_drive_1/map.png ]; then
  cp out/real/pullally_drive_1/map.png scripts/figures/pullally_map.png
fi
echo "update_readme: README.md and scripts/figures/ follow out/"

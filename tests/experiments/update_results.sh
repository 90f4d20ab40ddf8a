#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Puts what scripts wrote into out/ between the marks of tests/RESULTS.md, and the pictures that the
# pages show into scripts/figures: nothing there is typed.
# What was not made is left as it is: scripts/demo.sh, tests/experiments/tube_seeds.sh,
# tests/benchmark/benchmark.sh, tests/experiments/real_recordings.sh and
# tests/experiments/compare_figure.sh make it.
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
page=tests/RESULTS.md

# insert NAME FILE SCRIPT: replaces what stands between the two marks of NAME by FILE, indented.
insert() {
  if [ ! -s "$2" ]; then
    echo "update_results: \"$1\" left as it is ($3 was not run)"
    return
  fi
  grep -q "^<!-- $1: " $page && grep -q "^<!-- end of $1 -->" $page || {
    echo "update_results: $page has lost its marks \"$1\"" >&2
    exit 1
  }
  awk -v name="$1" -v file="$2" '
    index($0, "<!-- " name ": ") == 1 {
      print; print "";
      while ((getline line < file) > 0) print (line == "" ? "" : "    " line);
      print ""; skip = 1; next
    }
    index($0, "<!-- end of " name " -->") == 1 { skip = 0 }
    !skip' $page >$page.new
  mv $page.new $page
  echo "update_results: \"$1\" follows $2"
}

# picture FILE NAME
picture() { if [ -s "$1" ]; then cp "$1" "scripts/figures/$2"; fi; }

insert "demo tables" out/demo/tables.txt scripts/demo.sh
insert "tube seeds" out/tube_seeds.txt tests/experiments/tube_seeds.sh
insert "benchmarks" out/benchmark/summary.txt tests/benchmark/benchmark.sh
insert "real recordings" out/real/summary.txt tests/experiments/real_recordings.sh
picture out/demo/map.png demo_map.png
picture out/real/pullally_drive_1/map.png pullally_map.png
picture out/compare_figure/changes/compare.png compare.png

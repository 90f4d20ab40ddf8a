#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes tests/data/row anew: eight seconds of the simulated orchard as a recording folder.
# Needs build/bin/orchard and build/experiments/log_to_folder.
set -euo pipefail
cd "$(dirname "$0")/../.."
case "${1:-}" in -h | --help) sed -n '3,4s/^# //p' "$0"; exit 0 ;; esac
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

build/bin/orchard simulate --scene orchard --seed 3 --config config/orchard.yaml --from 2 --duration 8 \
  --out "$work/row.lcm" --truth "$work/truth.csv"
rm -rf tests/data/row
build/experiments/log_to_folder "$work/row.lcm" tests/data/row 4 8
gzip -n -9 tests/data/row/scans.csv
# What stands beside this piece of the drive; the rest is never in view.
awk -F, 'NR == 1 || ($2 > -3 && $2 < 3 && $3 > 3 && $3 < 15)' "$work/truth.csv" >tests/data/row/truth.csv
du -sh --apparent-size tests/data/row

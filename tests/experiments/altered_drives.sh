#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What the keys of config/pullally*.yaml are worth on drives other than the one they were chosen on:
# maps altered copies of it (backwards, mirrored, thinned, noisier, parts of it, its track drifting
# ...), with the track and from the laser alone, and prints a table. Some 20 s of one core each.
#   tests/experiments/altered_drives.sh [RECORDING [SEED [NAME...]]]
#     RECORDING  a folder (default ../shared/data/pullally_drive_1)
#     SEED       of the noise (default 1)
#     NAME       which copies (default all; build/experiments/altered_drive names)
# BUILD=DIR uses another build folder than build/, RIG=FILE and RIG_ALONE=FILE other rigs, and
# OUT=DIR another place for the maps than out/altered.
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
recording=${1:-../shared/data/pullally_drive_1}
seed=${2:-1}
[ -d "$recording" ] || { echo "altered_drives: there is no folder $recording" >&2; exit 3; }
bin=${BUILD:-build}/bin
[ -x "$bin/orchard" ] || scripts/build.sh all experiments
rig=${RIG:-config/pullally.yaml} rig_alone=${RIG_ALONE:-config/pullally_laser_only.yaml}
out=${OUT:-out/altered}
mapfile -t names < <("$bin/../experiments/altered_drive" names | cut -d" " -f1)
[ $# -le 2 ] || names=("${@:3}")

mkdir -p "$out"
{
  echo "                            with the track ($(basename "$rig" .yaml))   the laser alone ($(basename "$rig_alone" .yaml))"
  echo "                      clear trees                      path   clear trees   path  of the same"
  echo "copy            scans   all  once twice  scat.  rows  RMSE    once twice  RMSE  trees   beside"
  for name in "${names[@]}"; do
    "$bin/../experiments/altered_drive" write "$recording" "$name" "$seed" "$out/$name.lcm"
    "$bin/orchard" map "$out/$name.lcm" --config "$rig" --out "$out/$name" >/dev/null
    "$bin/orchard" map "$out/$name.lcm" --config "$rig_alone" --out "$out/${name}_alone" >/dev/null
    "$bin/../experiments/altered_drive" judge "$recording" "$name" "$seed" "$out/$name" "$out/${name}_alone"
  done
} | tee "$out/summary.txt"

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Maps compared, numbered anew and merged over random blocks of 10 rows of 30 trees (4 m x 2 m, 8 %
# missing), mapped without scans: looks, noise and slow bends of two drives or three robots. Prints
# what was found of changes and how honest its confidences are, what ids and numbers were kept, and
# what came of three robots' partial maps, each in a frame of its own. Seeds FIRST to LAST (1 to 60;
# those above 1000 are for choosing). Some 6 s of one core a seed. Needs a build in build/ (or
# BUILD=folder).
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
trials=${BUILD:-build}/experiments/two_map_trials
first=${1:-1}
last=${2:-60}
for mode in changes ids merge; do
  echo "== $mode, seeds $first to $last"
  "$trials" "$mode" "$first" "$last" || echo "$mode: not all that is wanted"
done

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What the engine of a farm costs beside its steps, by this machine's cores and by a Slurm of one node:
# processor time of everything less that of the steps' own commands, and the same farm on one core and
# on two, the time that passed. Ratios of one run each; a busy machine makes the second one worse. Then
# farm_scale.py puts these costs into the graph of a large farm. Slurm's part as in farm.sh.
#
# usage: tests/experiments/farm_costs.sh [BLOCKS [DATES [ROBOTS]]]     (default 4 2 2)
#   SLURM=no   without Slurm's part
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
. "$(dirname "$0")/farm_start.sh"
farm=$work/two
farm_rigs .
make_season "$farm" "${1:-4}" "${2:-2}" "${3:-2}"
cp -r "$farm" "$work/one"
cp -r "$farm" "$work/slurm"

# run FARM ARGUMENTS...: seconds passed, of processor with all children, of the steps alone, steps
run() {
  local farm=$1 TIMEFORMAT='%R %U %S'
  shift
  { time "$orchard" farm run "$farm" "$@" >"$work/said" 2>&1; } 2>"$work/time"
  awk -v steps="$(num_made "$farm")" 'FNR == NR { wall = $1; all = $2 + $3; next } { own += $2 }
    END { print wall, all, own, steps }' "$work/time" <(cd "$farm" && cat work/cost/*.txt)
}
read -r two_wall two_all two_own steps < <(run "$work/two" --cores 2)
read -r one_wall one_all one_own _ < <(run "$work/one" --cores 1)
awk -v steps="$steps" -v a="$two_all" -v b="$two_own" -v c="$one_all" -v d="$one_own" \
  -v one="$one_wall" -v two="$two_wall" 'BEGIN {
  printf "%d steps, %.2f s of processor each; the engine beside them: %.2f s a step (%.0f %%) on two cores, %.2f on one\n",
    steps, b / steps, (a - b) / steps, 100 * (a - b) / b, (c - d) / steps
  printf "one core %.0f s, two cores %.0f s: %.2f times as fast\n", one, two, one / two }'
if [ "${SLURM:-yes}" = yes ] && has_slurm; then
  start_slurm "$work/cluster"
  read -r wall all own _ < <(run "$work/slurm" --profile slurm --cores 8)
  # what Slurm itself runs is no child: its steps are left out on both sides
  awk -v steps="$steps" -v all="$all" -v wall="$wall" -v own="$own" -v two="$two_wall" 'BEGIN {
    printf "Slurm: the engine alone %.2f s of processor a step; %.0f s, %.2f times two cores without it\n",
      all / steps, wall, wall / two }'
fi

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A grower's plan laid on maps of random orchards: 5 % of the trees missing, 2 % extra, 1 % out of
# place, one row shifted. `near`: both are georeferenced, 0.7 m and a quarter of a degree apart; `far`:
# without satellites; `rectangle`: the same, and the orchard is its own image when turned. Prints what
# share of names is right and how well deviations are found. Seeds FIRST to LAST (1 to 50; those above
# 1000 are for choosing). Some 1 s of one core a seed. Needs a build in build/ (or BUILD=folder).
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
for mode in near far rectangle; do
  "${BUILD:-build}"/experiments/plan_trials "$mode" "${1:-1}" "${2:-50}"
done

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Prints how many of 15 poles of 70 mm with reflectors are found within 0.05 m with `reflector:
# only`, where boards and bushes stand 4 to 15 cm behind them, reflectors bloom into one beam on either
# side and a fifth of the looks shows none. Needs a build in build/ (or BUILD=folder).
#   tests/experiments/beacons.sh [SEEDS [FIRST]]   (default 20 from 1)
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
"${BUILD:-build}/experiments/beacons" "$@"

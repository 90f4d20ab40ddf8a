#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Prints how well the map knows the widths of 50 to 400 mm at 0.6 to 8.5 m, from 30 looks each,
# through beams that are spots of 0 to 38 mm: bias, spread, the Cramer-Rao bound of counting
# beams, the normalised error squared that width_sd_m promises, and the bias of taking the beams for
# lines. `mixed` has a wall 1.5 m behind and every fifth split spot reads in between. Needs a build in
# build/ (or BUILD=folder).
#   tests/experiments/thin_widths.sh [TRUNKS [FIRST_SEED]]   (default 100 from 1)
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
"${BUILD:-build}/experiments/thin_widths" "$@"

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Prints how well trunks' widths and centres are measured by the angle they fill and by a circle through
# their arc: 90, 125 and 230 mm at 0.5 to 6 m, whole and partly hidden, by three scanners. Exact
# rays, seeded noise. Needs a build in build/ (or BUILD=folder).
#   tests/experiments/laser_widths.sh [SEEDS [FIRST]]   (default 400 from 5001)
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
"${BUILD:-build}/experiments/laser_widths" "$@"

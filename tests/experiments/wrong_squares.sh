#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Is a wrong size of the board's squares refused, and the true one named? Calibrates laser to camera
# over seeds 1-5 (or FIRST LAST) with squares stated as 0.80 to 1.20 of what they are, with the
# board's outer size measured and without. Prints how many are refused, how many name the true
# size, and by how much the worst is off (2 % wanted). Needs a build in build/ (or BUILD=folder).
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
for outer in edges no-edges; do
  for stated in 0.80 0.85 0.90 0.95 1.05 1.10 1.15 1.20; do
    "${BUILD:-build}/experiments/laser_camera_seeds" "${1:-1}" "${2:-5}" 20 1 "$outer" 0 - "$stated" \
      2>/dev/null | grep -e calibrated -e squares
  done
done

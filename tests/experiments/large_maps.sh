#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Lays two maps of a large block, each in a frame of its own, on each other as `--any-place` does:
# how long that takes, and whether it is right; maps of two blocks must be refused. Exit code 1 when
# one was laid wrongly. Needs a build in build/ (or BUILD=folder).
#   tests/experiments/large_maps.sh [TREES [FIRST_SEED [LAST_SEED]]]   (default 20000 1 62)
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
"${BUILD:-build}"/experiments/large_map_trials "${1:-20000}" "${2:-1}" "${3:-62}"

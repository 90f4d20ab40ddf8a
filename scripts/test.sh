#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds everything and runs every test. Needs nothing done before; ends with ctest's own summary.
#   scripts/test.sh             all tests
#   scripts/test.sh -R mapper   arguments go to ctest
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/build.sh
echo "== ctest --test-dir build --output-on-failure -j2 $*"
exec ctest --test-dir build --output-on-failure --no-tests=error -j2 "$@"

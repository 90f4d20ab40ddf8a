#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds everything and runs every test. Needs nothing done before; ends with ctest's own summary.
#   scripts/test.sh             all tests
#   scripts/test.sh -R mapper   arguments go to ctest
set -euo pipefail
case "${1:-}" in -h | --help) sed -n '/^[^#]/q; /^#!/d; /^# SPDX/d; s/^# \{0,1\}//p' "$0"; exit 0 ;; esac
cd "$(dirname "$0")/.."

scripts/build.sh
echo "== ctest --test-dir build --output-on-failure -j2 $*"
exec ctest --test-dir build --output-on-failure --no-tests=error -j2 "$@"

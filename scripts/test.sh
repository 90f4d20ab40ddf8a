#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds everything and runs every test. Needs nothing done before; ends with ctest's summary and the
# tests that were skipped, each with its reason.
#   scripts/test.sh             all tests
#   scripts/test.sh -R mapper   arguments go to ctest
set -euo pipefail
cd "$(dirname "$0")/.."
case "${1:-}" in -h | --help) sed -n '3,6s/^# \{0,1\}//p' "$0"; exit 0 ;; esac

scripts/install_deps.sh --tests
scripts/build.sh
echo "== ctest --test-dir build --output-on-failure -j2 $*"
code=0
ctest --test-dir build --output-on-failure --no-tests=error -j2 "$@" | tee build/ctest.log || code=$?
tests/skipped_tests.sh build build/ctest.log
exit $code

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Build everything and run all tests. Prints the summary of ctest at the end, and the skipped tests
# with their reasons.
#   scripts/test.sh             all tests
#   scripts/test.sh -R mapper   arguments for ctest
#   scripts/test.sh --all       also the tests that need QGIS (about 1 GB); then arguments for ctest
set -euo pipefail
cd "$(dirname "$0")/.."
case "${1:-}" in -h | --help) sed -n '3,7s/^# \{0,1\}//p' "$0"; exit 0 ;; esac

packages=--tests
if [ "${1:-}" = --all ]; then
  packages=--all
  shift
fi
scripts/install_deps.sh $packages
scripts/build.sh all tests
num_jobs=$(($(nproc) + 1))  # many tests wait for messages
echo "== ctest --test-dir build --output-on-failure -j$num_jobs $*"
code=0
ctest --test-dir build --output-on-failure --no-tests=error -j$num_jobs "$@" | tee build/ctest.log || code=$?
tests/skipped_tests.sh build build/ctest.log
exit $code

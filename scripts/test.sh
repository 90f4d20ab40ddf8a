#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds everything and runs every test. Needs nothing done before; ends with ctest's summary and the
# tests that were skipped, each with its reason.
#   scripts/test.sh             all tests
#   scripts/test.sh -R mapper   arguments go to ctest
#   scripts/test.sh --all       also what needs QGIS, a gigabyte; ctest's arguments behind it
set -euo pipefail
cd "$(dirname "$0")/.."
case "${1:-}" in -h | --help) sed -n '3,7s/^# \{0,1\}//p' "$0"; exit 0 ;; esac

packages=--tests
if [ "${1:-}" = --all ]; then
  packages=--all
  shift
fi
scripts/install_deps.sh $packages
scripts/build.sh
echo "== ctest --test-dir build --output-on-failure -j2 $*"
code=0
ctest --test-dir build --output-on-failure --no-tests=error -j2 "$@" | tee build/ctest.log || code=$?
tests/skipped_tests.sh build build/ctest.log
exit $code

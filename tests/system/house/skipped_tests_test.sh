#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# skipped_tests.sh must name a skipped ctest and a skipped GoogleTest, with their reasons, and no other.
set -euo pipefail
skipped_tests=${1:?usage: skipped_tests_test.sh SKIPPED_TESTS_SH}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cat >"$work/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.22)
project(three_tests NONE)
enable_testing()
add_test(NAME whole COMMAND sh -c "echo first; echo 'skipped: no namespace is allowed'; exit 77")
set_tests_properties(whole PROPERTIES SKIP_RETURN_CODE 77)
add_test(NAME program COMMAND cat ${CMAKE_SOURCE_DIR}/program.txt)
add_test(NAME passes COMMAND true)
END
cat >"$work/program.txt" <<'END'
[ RUN      ] Map.OfPoles
map_test.cpp:72: Skipped
the recording poles is not here

[  SKIPPED ] Map.OfPoles (0 ms)
[ RUN      ] Map.OfTubes
[       OK ] Map.OfTubes (3 ms)
[  SKIPPED ] 1 test, listed below:
[  SKIPPED ] Map.OfPoles
END
cmake -S "$work" -B "$work/build" >/dev/null
ctest --test-dir "$work/build" >"$work/ctest.log"
bash "$skipped_tests" "$work/build" "$work/ctest.log" >"$work/said"
cat >"$work/expected" <<'END'
skipped: 2 tests
  whole - skipped: no namespace is allowed
  program: Map.OfPoles - the recording poles is not here
END
diff "$work/expected" "$work/said"

ctest --test-dir "$work/build" -R passes >"$work/ctest.log"
[ "$(bash "$skipped_tests" "$work/build" "$work/ctest.log")" = "skipped: no test" ] ||
  { echo "a test that passed is named"; exit 1; }
echo "skipped_tests.sh names what was skipped"

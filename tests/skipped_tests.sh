#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# skipped_tests.sh BUILD CTEST_OUTPUT: names every test that the last run of ctest in BUILD skipped, and
# why: whole tests (exit code 77) and single tests inside GoogleTest programs, which ctest counts as
# passed. CTEST_OUTPUT is what ctest printed.
set -euo pipefail
log=${1:?usage: skipped_tests.sh BUILD CTEST_OUTPUT}/Testing/Temporary/LastTest.log
printed=${2:?usage: skipped_tests.sh BUILD CTEST_OUTPUT}
[ -f "$log" ] || { echo "skipped tests: no $log, so nothing was run"; exit 1; }

awk '
  FILENAME == ARGV[1] {  # "  3/80 Test #12: demo ....***Skipped   0.02 sec"
    if (match($0, /Test +#[0-9]+: [^ ]+ .*\*\*\*Skipped/)) { split($0, part, /#[0-9]+: /); split(part[2], word, " "); whole[word[1]] = 1 }
    next
  }
  / Testing: / { name = $0; sub(/.* Testing: /, "", name); inside = 0; last = ""; said = ""; next }
  /^Output:$/ { inside = 1; next }
  /^<end of output>$/ {
    if (name in whole) report(name, said != "" ? said : last)
    inside = 0
    next
  }
  !inside { next }
  /^\[ RUN  / { reason = ""; taking = 0; next }
  /: Skipped$/ { taking = 1; reason = ""; next }
  /^\[  SKIPPED \] .* ms\)$/ {
    single = $0; sub(/^\[  SKIPPED \] /, "", single); sub(/ \([0-9]+ ms\)$/, "", single)
    report(name ": " single, reason)
    taking = 0
    next
  }
  /^-*$/ { next }
  taking { reason = reason == "" ? $0 : reason " " $0; next }
  { last = $0 }
  /[Ss]kipped|not allowed/ { if (said == "") said = $0 }
  function report(test, why) { lines[++n] = "  " test " - " (why == "" ? "no reason was given" : why) }
  END {
    if (n == 0) print "skipped: no test"
    else {
      printf "skipped: %d test%s\n", n, n == 1 ? "" : "s"
      for (i = 1; i <= n; ++i) print lines[i]
    }
  }' "$printed" "$log"

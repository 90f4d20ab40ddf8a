#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# house_rules.sh must pass a clean tree and name each kind of violation in a dirty one.
set -euo pipefail
checker=${1:?usage: house_rules_test.sh CHECKER}
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT

clean() {
  rm -rf "${tree:?}"/*
  mkdir -p "$tree"/lib/laser "$tree"/lib/bus/messages "$tree"/procs/mapper "$tree"/tests
  local licence='// SPDX-License-Identifier: BSD-3-Clause'
  echo "$licence" >"$tree/lib/laser/scan.hpp"
  echo "$licence" >"$tree/procs/mapper/main.cpp"
  printf '%s\n    {Channel::kScan, "SCAN", "scan_t", Role::kSource},\n' "$licence" >"$tree/lib/bus/messages/channel.hpp" ||
    exit 1  # what follows "clean &&" must not be passed over
}

expect() {  # expect CODE WHAT
  local code=0
  bash "$checker" "$tree" >"$tree.out" 2>&1 || code=$?
  if [ "$code" -ne "$1" ]; then
    echo "expected exit $1 for: $2; got $code"
    cat "$tree.out"
    exit 1
  fi
  rm -f "$tree.out"
}

clean && expect 0 "a clean tree"
clean && echo '#include <chrono>' >>"$tree/lib/laser/scan.hpp" && expect 1 "a clock in lib/laser"
clean && echo '#include <lcm/lcm-cpp.hpp>' >>"$tree/procs/mapper/main.cpp" && expect 1 "LCM in procs"
clean && echo 'auto c = "SCAN";' >>"$tree/lib/laser/scan.hpp" && expect 1 "a channel name in lib/laser"
clean && yes '//' | head -n 61 >>"$tree/procs/mapper/main.cpp" && expect 1 "a long main"
clean && sed -i 1d "$tree/lib/laser/scan.hpp" && expect 1 "no licence line"
clean && echo '#include <opencv2/imgproc.hpp>' >>"$tree/lib/laser/scan.hpp" && expect 1 "a heavy header"
clean && touch "$tree/CHANGELOG.md" "$tree/SECURITY.md" && expect 0 "the pages of a project"
clean && echo '// SPDX-License-Identifier: BSD-3-Clause' >"$tree/lib/laser/fit_test.cpp" && expect 1 "a test's name"
clean && touch "$tree/notes.txt" && expect 1 "a stray file"
echo "house_rules.sh sees every kind of violation"

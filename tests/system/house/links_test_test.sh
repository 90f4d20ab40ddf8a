#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# links_test.sh must pass a whole tree and name each kind of dead end in a broken one.
set -euo pipefail
checker=${1:?usage: links_test_test.sh CHECKER}
tree=$(mktemp -d)
trap 'rm -rf "$tree" "$tree.out"' EXIT

whole() {
  rm -rf "${tree:?}"/*
  mkdir -p "$tree"/lib/laser "$tree"/tests/unit
  printf '// %s\n' 'eq. '{1..13} 'figure '{3..13} 'table '{1,2} >"$tree/lib/laser/cut.cpp"
  echo 'void cut();' >>"$tree/lib/laser/cut.cpp"
  echo 'TEST(Cut, Cuts) {}' >"$tree/tests/unit/cut_test.cpp"
  printf '# Laser\n\n[up](../PAPER.md#from-a-to-b), `cut.cpp`\n' >"$tree/lib/laser/README.md"
  printf '# From A to B\n\n| 5 | `laser/cut.cpp` | `cut` | `unit/cut_test.cpp`: `Cut.Cuts` |\n' \
    >"$tree/lib/PAPER.md"
}

expect() {  # expect CODE WHAT
  local code=0
  bash "$checker" "$tree" >"$tree.out" 2>&1 || code=$?
  [ "$code" -eq "$1" ] && return 0
  echo "expected exit $1 for: $2; got $code"
  cat "$tree.out"
  exit 1
}

whole && expect 0 "a whole tree"
whole && echo '[x](missing.md)' >>"$tree/lib/laser/README.md" && expect 1 "a dead link"
whole && echo '[x](../PAPER.md#nowhere)' >>"$tree/lib/laser/README.md" && expect 1 "a dead anchor"
whole && echo 'run tests/unit/gone.sh' >>"$tree/lib/laser/README.md" && expect 1 "a dead path"
whole && echo '`gone.hpp`' >>"$tree/lib/laser/README.md" && expect 1 "a file that is gone"
whole && printf '| file | what |\n|---|---|\n| `gone` | x |\n' >>"$tree/lib/laser/README.md" &&
  expect 1 "a file of a table that is gone"
whole && sed -i 's/void cut/void slice/' "$tree/lib/laser/cut.cpp" && expect 1 "a function that is gone"
whole && sed -i 's/Cut, Cuts/Cut, Slices/' "$tree/tests/unit/cut_test.cpp" && expect 1 "a test that is gone"
whole && sed -i 's/eq\. 10/eq. 100/' "$tree/lib/laser/cut.cpp" && expect 1 "an equation without a line"
echo "links_test.sh sees every kind of dead end"

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A member that a snapshot leaves out is found; one that is kept, or made anew, is none.
# Usage: snapshot_members_test_test.sh PYTHON TEST
set -euo pipefail
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir "$tree/lib" "$tree/procs"

# as WHAT MEMBERS: whether the test fails ("bad") or not ("good") for a class with these members
as() {
  {
    echo 'class Counter {'
    echo ' public:'
    echo '  int num() const { return num_; }'
    echo '  void persist(StateArchive& archive);'
    echo
    echo ' private:'
    printf '%s\n' "${@:2}"
    echo '};'
  } >"$tree/lib/counter.hpp"
  echo 'void Counter::persist(StateArchive& archive) { archive(num_, times_); }' >"$tree/lib/counter.cpp"
  local outcome=good
  "$1" -B "$test" "$tree" >"$tree/said" || outcome=bad
  echo "$outcome"
}
python=$1
test=$2
expect() {
  local outcome
  outcome=$(as "$python" "${@:2}")
  [ "$outcome" = "$1" ] || { echo "FAIL: $outcome, not $1, of:"; printf '%s\n' "${@:2}"; cat "$tree/said"; exit 1; }
}
expect good '  int num_ = 0;' '  std::vector<std::pair<int, double>> times_{};'
expect bad '  int num_ = 0;' '  std::map<int, double> forgotten_;'
expect bad '  double num_ = 0.0, forgotten_ = 0.0;'
expect bad '  int num_ = 0;' '  struct Inner {' '    int a = 0;' '  };' '  Inner forgotten_;'
expect good '  mutable int cache_ = 0;' '  int num_ = 0;'
echo "ok"

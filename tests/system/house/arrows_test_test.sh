#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# arrows_test.py sees an include against the order, between rooms and between folders of a room, a
# room that is not listed, and an include of nothing.
#   arrows_test_test.sh PYTHON ARROWS_TEST
set -euo pipefail
python=${1:?usage: arrows_test_test.sh PYTHON ARROWS_TEST}
test=${2:?usage: arrows_test_test.sh PYTHON ARROWS_TEST}
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
fail() { echo "arrows_test_test: $*" >&2; exit 1; }

mkdir -p "$tree/lib/low" "$tree/lib/high/a" "$tree/lib/high/b"
printf 'low  # the ground\nhigh\nhigh/a\nhigh/b\n' >"$tree/lib/rooms.txt"
: >"$tree/lib/low/x.hpp"
: >"$tree/lib/high/a/x.hpp"
: >"$tree/lib/high/y.hpp"
echo '#include "low/x.hpp"' >"$tree/lib/high/a/up.cpp"
printf '#include "high/a/x.hpp"\n#include "high/y.hpp"\n' >"$tree/lib/high/b/up.cpp"
echo '#include "high/b/up.cpp"' >"$tree/lib/high/z.cpp"  # files of the room itself are free
"$python" -B "$test" "$tree" >/dev/null || fail "refused a tree in order"

# refused WHERE TEXT NAMED: a file with this include fails and the message names it.
refused() {
  echo "$2" >"$tree/lib/$1"
  local said
  if said=$("$python" -B "$test" "$tree"); then fail "did not see $2 in $1"; fi
  [[ $said == *"$3"* ]] || fail "does not say \"$3\": $said"
  rm "$tree/lib/$1"
}
refused low/down.cpp '#include "high/y.hpp"' 'low stands below high'
refused high/a/down.cpp '#include "high/b/up.cpp"' 'a stands below b'
refused low/gone.cpp '#include "low/gone.hpp"' 'which is not in lib'
mkdir "$tree/lib/new"
refused new/n.cpp '#include "low/x.hpp"' 'lib/new is not in'
echo "ok: an arrow against the order is seen"

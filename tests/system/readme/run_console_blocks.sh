#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the ```console blocks of a page as they stand, and compares what they print.
#   run_console_blocks.sh SOURCE BUILD PAGE
#     SOURCE  the checkout: its config/, scripts/ and tests/data are linked into an empty folder
#     BUILD   its build folder: BUILD/bin is on PATH
#     PAGE    the Markdown file
# "$ " begins a command; "> " continues one whose line ends in a backslash. Every other line is what
# the command above must print, standard output and error together; "..." on a line of its own stands
# for any lines, within a line for any text. A command without such lines may print what it likes. It
# must exit 0, or with N where the last line is "[exit N]". All blocks run in one shell, in order.
# Nothing may be left in the folder outside out/. Exit code 1 names every line that does not hold.
set -euo pipefail

if [ "${1:-}" != --inside ]; then
  [ $# -eq 3 ] || { sed -n '4,7s/^# //p' "$0" >&2; exit 2; }
  # A network of its own where that is allowed; without one the pages that need none still run.
  enter=(unshare -n)
  [ "$(id -u)" -eq 0 ] || enter=(unshare -rn)
  "${enter[@]}" true 2>/dev/null || enter=()
  exec "${enter[@]}" bash "$0" --inside "$@"
fi
source=$(realpath "$2") build=$(realpath "$3") page=$(realpath "$4")
if command -v ip >/dev/null && ip link set lo up multicast on 2>/dev/null; then
  ip route add 224.0.0.0/4 dev lo 2>/dev/null || true
fi

steps=$(mktemp -d)
work=$(mktemp -d)
trap 'rm -rf "$steps" "$work"' EXIT
mkdir "$work/tests"
ln -s "$source/config" "$source/scripts" "$work/"
ln -s "$source/tests/data" "$work/tests/data"

# One file N.command, one N.expected and one N.line per command of the page.
awk -v steps="$steps" '
  /^```/ {
    if (inside) { inside = 0; next }
    inside = ($0 ~ /^```console[ \t]*$/)
    continues = 0
    next
  }
  !inside { next }
  continues && /^> / { print substr($0, 3) > command; continues = /\\$/; next }
  /^\$ / {
    ++n
    command = sprintf("%s/%03d.command", steps, n)
    expected = sprintf("%s/%03d.expected", steps, n)
    print substr($0, 3) > command
    printf "" > expected
    print NR > sprintf("%s/%03d.line", steps, n)
    continues = /\\$/
    next
  }
  n == 0 { printf "%d: a console block begins with a command (\"$ ...\")\n", NR > steps "/broken"; exit }
  { print > expected; continues = 0 }' "$page"
if [ -s "$steps/broken" ]; then
  echo "$page:$(cat "$steps/broken")" >&2
  exit 1
fi
ls "$steps"/*.command >/dev/null 2>&1 || { echo "$page holds no console block"; exit 1; }

# holds EXPECTED PRINTED: whether the lines match, "..." standing for anything.
holds() {
  awk '
    function pattern(line) {
      gsub(/[][\\.^$*+?(){}|]/, "\\\\&", line)
      gsub(/\\\.\\\.\\\./, ".*", line)
      return "^" line "$"
    }
    { sub(/[ \t\r]+$/, "") }
    NR == FNR { want[++num_want] = $0; next }
    { got[++num_got] = $0 }
    END {
      while (num_want > 0 && want[num_want] == "") --num_want
      while (num_got > 0 && got[num_got] == "") --num_got
      i = j = 1; star = 0
      while (j <= num_got) {
        if (i <= num_want && want[i] == "...") { star = i++; mark = j; continue }
        if (i <= num_want && got[j] ~ pattern(want[i])) { ++i; ++j; continue }
        if (!star) exit 1
        i = star + 1; j = ++mark
      }
      while (i <= num_want && want[i] == "...") ++i
      exit i <= num_want
    }' "$1" "$2"
}

export PATH="$build/bin:$PATH"
cd "$work"
set +eu
failed=0
num=0
for step in "$steps"/*.command; do
  step=${step%.command}
  num=$((num + 1))
  where="$page:$(cat "$step.line")"
  wanted_code=$(sed -n '$s/^\[exit \([0-9]*\)\]$/\1/p' "$step.expected")
  sed -i '${/^\[exit [0-9]*\]$/d}' "$step.expected"
  eval "$(cat "$step.command")" >"$step.printed" 2>&1 </dev/null
  code=$?
  if [ "$code" -ne "${wanted_code:-0}" ]; then
    echo "$where: exit code $code, not ${wanted_code:-0}: $(cat "$step.command")"
    sed 's/^/    /' "$step.printed"
    failed=1
  elif [ -s "$step.expected" ] && ! holds "$step.expected" "$step.printed"; then
    echo "$where: prints something else: $(cat "$step.command")"
    diff -u --label "the page" --label "printed" "$step.expected" "$step.printed" | sed 's/^/    /'
    failed=1
  fi
done
left=$(ls -A "$work" | grep -vxE 'config|scripts|tests|out')
if [ -n "$left" ]; then
  echo "$page: its commands leave files outside out/:" $left
  failed=1
fi
[ $failed -ne 0 ] || echo "$page: $num commands run as they stand"
exit $failed

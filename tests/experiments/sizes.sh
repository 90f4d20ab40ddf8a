#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# How large the project is: lines and files per room, units per folder, configuration keys, named
# constants and words of the README, for this checkout and, with REV, for that commit beside it.
#   tests/experiments/sizes.sh [REV] [--build DIR] [--rev-build DIR]
#     REV              a commit of this repository
#     --build DIR      this checkout's build folder, for the keys that --print-config shows (default build)
#     --rev-build DIR  a build folder of REV, for the same; without one its keys are counted in the source only
# A unit is a .hpp, a .cpp, or both of one name. No folder should hold more than 20.
set -euo pipefail
cd "$(dirname "$0")/../.."

rev=
build_dir=build
rev_build=none
while [ $# -gt 0 ]; do
  case $1 in
    --build) build_dir=${2:?--build needs a folder}; shift ;;
    --rev-build) rev_build=${2:?--rev-build needs a folder}; shift ;;
    -h | --help) sed -n '3,9s/^# \{0,1\}//p' "$0"; exit 0 ;;
    -*) echo "sizes: unknown option $1; see $0 --help" >&2; exit 2 ;;
    *) rev=$1 ;;
  esac
  shift
done

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ -n "$rev" ]; then
  git rev-parse --verify --quiet "$rev^{commit}" >/dev/null || { echo "sizes: there is no revision $rev" >&2; exit 2; }
  mkdir "$work/tree"
  git archive "$rev" | tar -x -C "$work/tree"
fi

sources() { find "$@" \( -name '*.hpp' -o -name '*.cpp' \) 2>/dev/null; }

# keys PROGRAM OPTION: lines of --print-config that give a value, without the simulator's.
keys() {
  { "$1" --print-config $2 2>/dev/null || true; } | awk '
    /^[a-z_]+:/ { room = $1 }
    room != "simulation:" && /^ +[a-z_0-9]+: *[^# ]/ { n++ }
    END { print n + 0 }'
}

# measure TREE BUILD: lines "name<TAB>value", sorted by what they tell.
measure() {
  local tree=$1 build=$2 program folder
  (
    cd "$tree"
    for folder in lib/*/ procs/*/; do
      folder=${folder%/}
      printf 'lines %s\t%s\n' "$folder" "$(sources "$folder" | xargs -r cat | wc -l)"
      printf 'files %s\t%s\n' "$folder" "$(sources "$folder" | wc -l)"
    done
    for folder in lib procs tests; do
      printf 'lines %s, all\t%s\n' "$folder" "$(sources "$folder" | xargs -r cat | wc -l)"
      printf 'files %s, all\t%s\n' "$folder" "$(sources "$folder" | wc -l)"
    done
    sources lib procs | sed 's/\.[ch]pp$//' | sort -u | sed 's|/[^/]*$||' | sort | uniq -c |
      awk '{ printf "units %s\t%s\n", $2, $1 }'
    printf 'keys in the source, without simulation\t%s\n' "$(sources lib | grep -v '^lib/simulation/' |
      xargs grep -hoE '\bv\.(number|numbers|integer|flag|choice|text|path)\(' | wc -l)"
    printf 'constants in lib and procs\t%s\n' "$(sources lib procs |
      xargs grep -hE '^ *(static |inline )*(constexpr|const) [A-Za-z_:0-9<>, ]+ k[A-Z][A-Za-z0-9_]*( =|\{|\[)' | wc -l)"
    printf 'words of README.md\t%s\n' "$(wc -w <README.md)"
  )
  program=$build/bin/orchard-detector
  if [ -x "$program" ]; then
    local shown all
    shown=$(keys "$program" "")
    all=$(keys "$program" --all)
    [ "$all" -ge "$shown" ] || all=$shown  # a program without expert keys
    printf 'keys for users\t%s\nkeys for experts\t%s\n' "$shown" $((all - shown))
  fi
}

measure . "$PWD/$build_dir" >"$work/new"
if [ -n "$rev" ]; then
  measure "$work/tree" "$(realpath -m "$rev_build")" >"$work/old"
else
  : >"$work/old"
fi

awk -F'\t' -v rev="$rev" '
  FNR == 1 { file++ }
  FILENAME == ARGV[1] { old[$1] = $2; if (!($1 in seen)) { seen[$1] = 1; order[++n] = $1 } next }
  { new[$1] = $2; if (!($1 in seen)) { seen[$1] = 1; order[++n] = $1 } }
  function value(table, name) { return name in table ? table[name] : "-" }
  function line(name) {
    if (rev != "") printf "%-46s %9s %9s\n", name, value(old, name), value(new, name)
    else printf "%-46s %9s\n", name, value(new, name)
  }
  END {
    if (rev != "") printf "%-46s %9s %9s\n", "", rev, "now"
    for (i = 1; i <= n; ++i) if (order[i] ~ /^(lines|files) /) line(order[i])
    for (i = 1; i <= n; ++i) if (order[i] !~ /^(lines|files|units) /) line(order[i])
    for (i = 1; i <= n; ++i) if (order[i] ~ /^units /) {
      folders += order[i] in new
      if (old[order[i]] > 20 || new[order[i]] > 20) { line(order[i]) }
      if (new[order[i]] > most) { most = new[order[i]]; where = order[i] }
    }
    sub(/^units /, "", where)
    printf "now: %d folders in lib and procs, at most %d units in one (%s)\n", folders, most, where
  }' "$work/old" "$work/new"

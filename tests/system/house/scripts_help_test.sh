#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Every script that people run answers -h and --help with the comment at its head and refuses an
# option that it does not know, before it does anything.
#   scripts_help_test.sh SOURCE_TREE
set -uo pipefail
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
cd "$1" || exit 2
# A copy of the scripts alone: what they would build, simulate or install is not there.
find scripts tests/script_help.sh tests/experiments tests/benchmark tests/fuzz -name '*.sh' |
  xargs cp --parents -t "$tree"
cd "$tree" || exit 2
before=$(find . | sort)
failed=0
num=0

# wrong SCRIPT WHAT: a line of the report
wrong() {
  echo "$1: $2"
  failed=1
}

for script in scripts/*.sh tests/*/*.sh; do
  [ -x "$script" ] || continue  # sourced by others
  num=$((num + 1))
  about=$(sed -n '/^#!/d; /^# SPDX/d; s/^# //p; q' <(grep -v '^#!\|^# SPDX' "$script"))
  for option in -h --help; do
    said=$(PATH=/usr/bin:/bin timeout 10 "./$script" $option 2>&1 </dev/null)
    code=$?
    [ $code -eq 0 ] || wrong "$script" "$option ends with exit code $code"
    [ "$(head -n 1 <<<"$said")" = "$about" ] || wrong "$script" "$option does not print its head"
    ! grep -q 'SPDX\|^set -' <<<"$said" || wrong "$script" "$option prints more than its head"
  done
  # Where options go to another program, that one refuses them.
  case $script in scripts/spy.sh | scripts/test.sh) continue ;; esac
  said=$(PATH=/usr/bin:/bin timeout 10 "./$script" --no-such-option 2>&1 </dev/null)
  code=$?
  [ $code -eq 2 ] || wrong "$script" "an unknown option ends with exit code $code"
  grep -q -- '--help' <<<"$said" || wrong "$script" "an unknown option gets no pointer to --help"
done
# What a script asks its user to install, install_deps installs.
for package in $(grep -ho 'apt-get install [-a-z0-9 ]*' scripts/spy.sh | sed 's/apt-get install//; s/--[-a-z]*//g'); do
  grep -qw -- "$package" scripts/install_deps.sh || wrong scripts/install_deps.sh "does not install $package"
done
[ $num -gt 10 ] || wrong scripts "only $num of them were found"
cd "$1" || exit 2
for program in tests/experiments/experiment tests/field/field.py; do
  "$program" --help 2>&1 | grep -q '^usage: ' || wrong "$program" "--help does not tell its use"
  "$program" --no-such-option >/dev/null 2>&1
  [ $? -eq 2 ] || wrong "$program" "an unknown option does not end with exit code 2"
done
cd "$tree" || exit 2
[ "$(find . | sort)" = "$before" ] || wrong scripts "something was written"
exit $failed

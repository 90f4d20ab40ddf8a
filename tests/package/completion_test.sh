#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# completion_test.sh BIN BUILD_HELP: what bash completes must be what the programs accept, and every command
# must have its manual page (where help2man was found).
set -euo pipefail
bin=${1:?usage: completion_test.sh BIN BUILD_HELP}
help=${2:?usage: completion_test.sh BIN BUILD_HELP}
. "$help/completion/orchard"

completions() {
  COMP_WORDS=("$@")
  COMP_CWORD=$(($# - 1))
  _orchard
  echo "${COMPREPLY[*]}"
}
expect() {  # expect WANTED WORDS...
  local wanted=$1 got
  shift
  got=$(completions "$@")
  [ "$got" = "$wanted" ] || { echo "'$*' completes to '$got', not '$wanted'"; exit 1; }
}
expect "info" orchard log inf
expect "--truth" orchard simulate --tru
expect "" orchard map --config ""  # a file: left to the shell
expect "--print-config" orchard-detector --print

# Every subcommand that is offered answers --help.
for command in $(completions orchard ""); do
  case $command in -*) continue ;; esac
  "$bin/orchard" "$command" --help >/dev/null || { echo "orchard $command --help fails"; exit 1; }
  [ ! -d "$help/man" ] || [ -s "$help/man/orchard-$command.1" ] || { echo "no page orchard-$command.1"; exit 1; }
done
echo "completion and manual pages say what the programs say"

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
expect "renumber" orchard edit ren
expect "--class" orchard edit add --cl
expect "--print-config" orchard-detector --print

# Every subcommand that is offered answers --help.
for command in $(completions orchard ""); do
  case $command in -*) continue ;; esac
  "$bin/orchard" "$command" --help >/dev/null || { echo "orchard $command --help fails"; exit 1; }
  [ ! -d "$help/man" ] || [ -s "$help/man/orchard-$command.1" ] || { echo "no page orchard-$command.1"; exit 1; }
done
# A command below another has its own page, and nothing that is no command has one: as many pages as commands that
# a user can complete to, and programs that say something else than orchard.
walk() {  # walk COMMAND...: it and all commands below it, one a line
  local word
  echo "$*"
  for word in $(completions "$@" ""); do
    case $word in -*) ;; *) walk "$@" "$word" ;; esac
  done
}
if [ -d "$help/man" ]; then
  num_commands=$({ walk orchard; for program in "$bin"/orchard-*; do
    cmp -s <("$program" --help) <("$bin/orchard" --help) || basename "$program"; done; } | wc -l)
  num_pages=$(find "$help/man" -name '*.1' | wc -l)
  [ "$num_pages" = "$num_commands" ] || { echo "$num_pages manual pages of $num_commands commands"; exit 1; }
  grep -q 'tree|object' "$help/man/orchard-edit-add.1" || { echo "orchard-edit-add.1 is another command's"; exit 1; }
  twins=$(for page in "$help"/man/*.1; do sed '/^\.TH /d; /^\.SH NAME/,/^\.SH /d' "$page" | md5sum; done | sort | uniq -d)
  [ -z "$twins" ] || { echo "some manual pages say the same"; exit 1; }
fi
echo "completion and manual pages say what the programs say"

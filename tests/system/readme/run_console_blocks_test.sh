#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The runner of pages passes what holds and sees every kind of page that does not.
#   run_console_blocks_test.sh SOURCE BUILD
set -uo pipefail
here=$(cd "$(dirname "$0")" && pwd)
pages=$(mktemp -d)
trap 'rm -rf "$pages"' EXIT
failed=0

# page EXIT_CODE NAME WORDS: the page on standard input ends so, and its report holds the words.
page() {
  cat >"$pages/$2.md"
  local report code
  report=$("$here/run_console_blocks.sh" "$source" "$build" "$pages/$2.md" 2>&1)
  code=$?
  if [ $code -eq "$1" ] && [[ $report == *"$3"* ]]; then return; fi
  echo "$2: exit code $code, wanted $1 with \"$3\":"
  echo "$report"
  failed=1
}
source=$1 build=$2

page 0 holds "8 commands run" <<'PAGE'
Not run:

    $ false

```sh
$ false
```
```console
$ echo one; echo two 1.234 s; echo three
one
two ... s
...
$ mkdir -p out && touch out/file
$ printf '%s ' a \
> b
a b
$ seq 1 9
1
...
5
...
9
```
```
$ false
```
```console
$ variable=kept; ls config/tubes.yaml
config/tubes.yaml
$ echo "$variable (a.c) [x]*"
kept (a.c) [x]*
$ echo wrong >&2; (exit 3)
wrong
[exit 3]
$ echo of no interest
```
PAGE
page 1 other_text 'other_text.md:2: prints something else' <<'PAGE'
```console
$ echo one
two
```
PAGE
page 1 a_dot_is_a_dot "prints something else" <<'PAGE'
```console
$ echo abc
a.c
```
PAGE
page 1 too_little "prints something else" <<'PAGE'
```console
$ echo one
one
two
```
PAGE
page 1 too_much "prints something else" <<'PAGE'
```console
$ seq 1 3
1
...
2
```
PAGE
page 1 exit_code "exit code 1, not 0" <<'PAGE'
```console
$ false
```
PAGE
page 1 no_failure "exit code 0, not 3" <<'PAGE'
```console
$ true
[exit 3]
```
PAGE
page 1 litter "leave files outside out/: litter" <<'PAGE'
```console
$ touch litter
```
PAGE
page 1 nothing "holds no console block" <<'PAGE'
```sh
true
```
PAGE
exit $failed

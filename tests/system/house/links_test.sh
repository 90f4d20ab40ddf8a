#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks that the pages of the source tree given as $1 name only what exists: relative links, paths
# of files, and on lib/PAPER.md functions and tests; that every module with six headers or more has a
# page; that each experiment is listed; that README.md keeps to its 120 lines. Prints every name that
# leads nowhere; exits 1 when there is one.
set -uo pipefail
root=${1:?usage: links_test.sh SOURCE_TREE}
cd "$root" || exit 2
failed=0

complain() {
  echo "$1"
  failed=1
}

pages() {
  find . \( -path ./.git -o -path './build*' -o -path ./out \) -prune -o -name '*.md' -print |
    sed 's,^\./,,' | sort
}

# Names of the pages "how to add ...": made by the reader.
example='thinner|thing_test|name_t|NAME|REV'
folders='lib|procs|config|scripts|tests|lcmtypes'

# The anchor that a page's reader makes of a heading.
anchors() {
  sed -nE 's/^#+ +//p' "$1" | tr '[:upper:]' '[:lower:]' | sed -E 's/[^a-z0-9 _-]//g; s/ /-/g'
}

# any_exists PATTERN...: whether one of the patterns names something.
any_exists() {
  local pattern
  for pattern in "$@"; do compgen -G "$pattern" >/dev/null && return 0; done
  return 1
}

check_links() {  # check_links PAGE
  local page=$1 folder target file
  folder=$(dirname "$page")
  while IFS= read -r target; do
    case $target in http://* | https://* | mailto:*) continue ;; esac
    file=${target%%#*}
    if [ -n "$file" ] && [ ! -e "$folder/$file" ]; then
      complain "$page: the link to $target leads nowhere"
    elif [[ $target == *#* ]]; then
      local where=$page
      [ -n "$file" ] && where=$folder/$file
      [[ $where == *.md ]] && ! anchors "$where" | grep -qxF -- "${target#*#}" &&
        complain "$page: no heading for the link to $target"
    fi
  done < <(grep -oE '\]\([^)[:space:]]+\)' "$page" | sed -E 's/^\]\((.*)\)$/\1/')
}

check_paths() {  # check_paths PAGE
  local page=$1 folder path
  folder=$(dirname "$page")
  # paths from the top of the tree, in text and in commands
  while IFS= read -r path; do
    any_exists "$path" "$folder/$path" || complain "$page: there is no $path"
  done < <(grep -oE "(^|[^A-Za-z0-9_./-])($folders)/[A-Za-z0-9_./*-]*[A-Za-z0-9_*]" "$page" |
    sed -E "s,^[^A-Za-z]*,," | grep -vE "$example" | sort -u)
  # names of files in backticks, from the page's folder, from lib or from procs
  while IFS= read -r path; do
    any_exists "$path" "$folder/$path" {lib,procs,tests,"procs/*"}/"$path" ||
      complain "$page: there is no $path"
  done < <(grep -oE '`[A-Za-z0-9_./*-]+\.(hpp|cpp|sh|md|awk|cmake)`' "$page" |
    tr -d '\`' | grep -vE "$example" | sort -u)
}

# In the tables of lib, a column named "file" holds names of files beside the page, without ending.
check_files() {  # check_files PAGE
  local page=$1 folder name
  [[ $page == lib/*/README.md ]] || return 0
  folder=$(dirname "$page")
  while IFS= read -r name; do
    any_exists "$folder/$name" "$folder/$name".{hpp,cpp} || complain "$page: there is no $name"
  done < <(awk -F'|' '
    !/^\|/ { column = 0; next }
    !column { for (i = 2; i < NF; ++i) if ($i ~ /^ *file *$/) column = i; if (!column) column = -1; next }
    column > 0 { print $column }' "$page" | grep -oE '`[^`]+`' | tr -d '\`' | sort -u)
}

# Each row of the paper's page: its functions stand in its files, its tests too.
check_paper() {
  local page=lib/PAPER.md line words files word suite name
  [ -f "$page" ] || return 0
  while IFS= read -r line; do
    words=$(grep -oE '`[^`]+`' <<<"$line" | tr -d '\`')
    files=$(grep -E '/.*\.[ch]pp$' <<<"$words" | sed -E 's,^(unit|system)/,tests/\1/,; t; s,^,lib/,')
    [ -n "$files" ] || continue
    while IFS= read -r word; do
      case $word in
        */*) [ -f "lib/$word" ] || [ -f "tests/$word" ] || complain "$page: there is no $word" ;;
        *.*)
          suite=${word%%.*} name=${word#*.}
          # shellcheck disable=SC2086
          grep -qE "TEST(_[FP])?\($suite, $name\)" $files || complain "$page: there is no test $word"
          ;;
        # shellcheck disable=SC2086
        *) grep -qw -- "$word" $files || complain "$page: $word is not in $(tr '\n' ' ' <<<"$files")" ;;
      esac
    done <<<"$words"
  done < <(grep '^|' "$page")
  # Figures 1 and 2 are photographs.
  for name in eq\.\ {1..13} [Ff]igures?\ {3..13} [Tt]able\ {1,2}; do
    grep -rqE --include='*.cpp' --include='*.hpp' "$name([^0-9]|$)" lib ||
      complain "no line of lib names the paper's $name"
  done
}

while IFS= read -r page; do
  check_links "$page"
  check_paths "$page"
  check_files "$page"
done < <(pages)
check_paper
while IFS= read -r folder; do
  headers=$(find "$folder" -maxdepth 1 -name '*.hpp' | wc -l)
  [ "$headers" -lt 6 ] || [ -f "$folder/README.md" ] || complain "$folder has no page"
done < <(find lib -type d | sort)
for script in tests/experiments/*.sh; do
  [ ! -f "$script" ] || grep -qF "\`${script##*/}\`" tests/experiments/README.md ||
    complain "tests/experiments/README.md lacks ${script##*/}"
done
if [ -f README.md ] && [ "$(wc -l <README.md)" -gt 120 ]; then
  complain "README.md has more than 120 lines"
fi
[ $failed -eq 0 ] && echo "every page names only what exists"
exit $failed

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# completion.sh BIN OUT: writes completion for bash, zsh and fish into OUT (orchard, _orchard,
# orchard.fish), from what --help says: commands, options, and files where a value is wanted.
set -euo pipefail
bin=${1:?usage: completion.sh BIN OUT}
out=${2:?usage: completion.sh BIN OUT}
. "$(dirname "$0")/commands.sh"
export PATH=$bin:$PATH
rm -rf "$out"
mkdir -p "$out"
mapfile -t all < <(commands orchard; for program in "$bin"/orchard-*; do basename "$program"; done)
programs=$(printf '%s\n' "${all[@]}" | cut -d' ' -f1 | sort -u | tr '\n' ' ')

words() {  # words COMMAND...: what can follow it
  { subcommands "$@"; options "$@"; } | cut -f1 | tr '\n' ' '
}
with_value() {  # options of a command that want one, as a shell pattern
  options "$@" | awk -F'\t' '$2 != "" { printf "%s%s", n++ ? "|" : "", $1 }'
}

# The table of all commands, the same for bash and zsh.
table() {
  local command pattern
  echo '  case "$path" in'
  for command in "${all[@]}"; do
    read -r -a parts <<<"$command"
    printf "    '%s') words='%s'" "$command" "$(words "${parts[@]}")"
    pattern=$(with_value "${parts[@]}")
    [ -z "$pattern" ] || printf '; case "$previous" in %s) words= ;; esac' "$pattern"
    echo ' ;;'
  done
  echo '  esac'
}

# bash: the path is the command and its subcommands as typed so far
{
  echo '# bash completion for Orchard Mapper, made from the help texts'
  echo '_orchard() {'
  echo '  local path=${COMP_WORDS[0]##*/} previous=${COMP_WORDS[COMP_CWORD-1]} words= word'
  echo '  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do'
  echo '    case "$path $word" in'
  printf '%s\n' "${all[@]}" | awk 'NF > 1 { printf "      \"%s\") path=\"$path $word\" ;;\n", $0 }'
  echo '    esac'
  echo '  done'
  table
  echo '  mapfile -t COMPREPLY < <(compgen -W "$words" -- "${COMP_WORDS[COMP_CWORD]}")'
  echo '}'
  echo "complete -o default -o bashdefault -F _orchard $programs"
} >"$out/orchard"

{
  echo "#compdef $programs"
  echo '# zsh completion for Orchard Mapper, made from the help texts'
  echo 'local path_=${words[1]:t} previous=${words[CURRENT-1]} word'
  echo 'for word in "${(@)words[2,CURRENT-1]}"; do'
  echo '  case "$path_ $word" in'
  printf '%s\n' "${all[@]}" | awk 'NF > 1 { printf "    \"%s\") path_=\"$path_ $word\" ;;\n", $0 }'
  echo '  esac'
  echo 'done'
  echo 'local choices='
  table | sed 's/"\$path"/"$path_"/; s/words=/choices=/g'
  echo '[[ -z $choices ]] || compadd -- ${=choices}'
  echo '[[ $PREFIX == -* ]] || _files'
} >"$out/_orchard"

quoted() { printf '%s' "${1//\'/}"; }
{
  echo '# fish completion for Orchard Mapper, made from the help texts'
  for command in "${all[@]}"; do
    read -r -a parts <<<"$command"
    condition=
    for part in "${parts[@]:1}"; do condition+="; and __fish_seen_subcommand_from $part"; done
    condition=${condition#; and }
    below=$(subcommands "${parts[@]}" | cut -f1 | tr '\n' ' ')
    here=${condition:-true}
    [ -z "$below" ] || here="$here; and not __fish_seen_subcommand_from ${below% }"
    while IFS=$'\t' read -r name what; do
      printf "complete -c %s -n '%s' -f -a %s -d '%s'\n" "${parts[0]}" "$here" "$name" "$(quoted "$what")"
    done < <(subcommands "${parts[@]}")
    while IFS=$'\x1f' read -r name value what; do
      printf "complete -c %s -n '%s' -l %s%s -d '%s'\n" "${parts[0]}" "$here" "${name#--}" \
        "${value:+ -r}" "$(quoted "$what")"
    done < <(options "${parts[@]}" | tr '\t' '\37')
  done
} >"$out/orchard.fish"
echo "completion: ${#all[@]} commands"

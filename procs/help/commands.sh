# SPDX-License-Identifier: BSD-3-Clause
# Sourced by manual_pages.sh and completion.sh: reads the --help of the programs.

# help_text COMMAND...: the output of its --help; each command is run once.
help_text() {
  local file
  file=$help_texts/$(IFS=_; echo "$*")
  [ -f "$file" ] || "$@" --help >"$file"
  cat "$file"
}
help_texts=$(mktemp -d)
trap 'rm -rf "$help_texts"' EXIT

# subcommands COMMAND...: lines "name<TAB>description".
subcommands() {
  help_text "$@" | awk '
    /^(Subcommands|Commands):/ { inside = 1; next }
    /^[^ ]/ { inside = 0 }
    inside && /^  [a-z]/ { name = $1; sub(/^ +[^ ]+ +/, ""); print name "\t" $0 }'
}

# options COMMAND...: lines "--name<TAB>value or empty<TAB>description".
options() {
  help_text "$@" | awk '
    /^(Options|\[Option Group)/ { inside = 1; next }
    /^[^ ]/ { inside = 0 }
    !inside { next }
    /^ +-/ {
      flush()
      line = $0; sub(/^ +/, "", line)
      words = line; text = ""
      if (match(line, /   */)) { words = substr(line, 1, RSTART - 1); text = substr(line, RSTART + RLENGTH) }
      split(words, word, " ")
      n = split(word[1], names, ",")
      name = names[n]
      value = word[2] ~ /^[[(]/ ? "" : word[2]  # text in brackets describes a flag
      next
    }
    { more = $0; sub(/^ +/, "", more); text = text == "" ? more : text " " more }
    function flush() { if (name != "") print name "\t" value "\t" text; name = "" }
    END { flush() }'
}

# commands COMMAND...: the command and every command below it, one per line.
commands() {
  local name
  echo "$*"
  while IFS=$'\t' read -r name _; do commands "$@" "$name"; done < <(subcommands "$@")
}

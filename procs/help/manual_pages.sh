#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# manual_pages.sh BIN OUT VERSION: writes one manual page per program and per command of `orchard`
# (orchard-map.1) into OUT, from what --help says. Needs help2man.
set -euo pipefail
bin=${1:?usage: manual_pages.sh BIN OUT VERSION}
out=${2:?usage: manual_pages.sh BIN OUT VERSION}
version=${3:?usage: manual_pages.sh BIN OUT VERSION}
. "$(dirname "$0")/commands.sh"
export PATH=$bin:$PATH
rm -rf "$out"
mkdir -p "$out"

page() {  # page COMMAND...
  local title what
  title=$(IFS=-; echo "$*")
  what=$(help_text "$@" | sed -n 1p | sed 's/^[A-Z][a-z]* Mapper: //')
  help2man --no-info --version-string="$version" --name="${what,}" --manual="Orchard Mapper" \
    --source="Orchard Mapper $version" "$*" |
    awk -v title="${title^^}" '
      /^\.TH / { sub(/^\.TH [^"]*"[^"]*"( "1")?/, ".TH " title " \"1\"") }
      name { sub(/^.* \\- /, tolower(title) " \\- "); name = 0 }
      /^\.SH NAME/ { name = 1 }
      /^\.SH / { if (examples) print ".fi"; examples = 0 }
      { print }
      /^\.SH EXAMPLES/ { examples = 1; print ".nf" }
      END { if (examples) print ".fi" }' |
    sed '/^\.SH EXAMPLES/,$ { /^\.IP$/d; /^\.PP$/d }' >"$out/$title.1"
}

mapfile -t all < <(commands orchard)
for command in "${all[@]}"; do
  read -r -a words <<<"$command"
  page "${words[@]}"
done
for program in "$bin"/orchard-*; do  # but for the companions of orchard, which are not called
  name=$(basename "$program")
  [ "$(help_text "$name")" = "$(help_text orchard)" ] || page "$name"
done
gzip -9nk "$out"/*.1
echo "manual pages: $(find "$out" -name '*.1' | wc -l)"

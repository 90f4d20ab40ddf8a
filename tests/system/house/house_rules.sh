#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks the rules of the house on the source tree given as $1. Prints every violation; exits 1
# when there is one.
set -uo pipefail
shopt -s lastpipe  # so that violations() sets failed in this shell
root=${1:?usage: house_rules.sh SOURCE_TREE}
cd "$root" || exit 2
failed=0

# violations RULE: reads offending lines from standard input.
violations() {
  local lines
  lines=$(cat)
  if [ -n "$lines" ]; then
    echo "VIOLATED: $1"
    echo "$lines" | sed 's/^/  /'
    failed=1
  else
    echo "kept: $1"
  fi
}

sources() { find "$@" -name '*.hpp' -o -name '*.cpp' | sort; }
# grep that is content with finding nothing, also in no file.
search() { xargs -r grep -nE "$1" /dev/null || true; }

# 1. computation is pure
mapfile -t pure < <(sources lib | grep -vE '^lib/(io|bus)/')
printf '%s\n' "${pure[@]}" |
  search '#include *[<"](lcm/|orchard/|spdlog/|thread>|mutex>|iostream>|fstream>|chrono>|ctime>|time\.h>|sys/|unistd\.h>)' |
  violations "lib outside io and bus includes no LCM, log, thread, stream, file, clock or system header"

# 2. only the bus knows LCM
sources lib procs | grep -vE '^lib/bus/' | search '#include *[<"](lcm/|orchard/[a-z_]*_t\.hpp)' |
  violations "only lib/bus includes LCM and the generated types"

# 3. one table of channel names
names=$(sed -nE 's/^ *\{Channel::k[A-Za-z]+, "([A-Za-z_.]+)".*/\1/p' lib/bus/messages/channel.hpp | paste -sd'|')
[ -n "$names" ] || { echo "VIOLATED: lib/bus/messages/channel.hpp holds no table of channels"; failed=1; }
sources lib procs | grep -v '^lib/bus/messages/channel.hpp$' | search "\"(${names:-none})\"" |
  violations "no channel name outside lib/bus/messages/channel.hpp"

# 4. thin mains
for main in procs/*/main.cpp; do
  [ -f "$main" ] || continue
  lines=$(wc -l <"$main")
  [ "$lines" -le 60 ] || echo "$main: $lines lines"
done | violations "main.cpp of a process has at most 60 lines"

# 5. licence line first
comm -13 <(sources lib procs tests | xargs -r awk '$0 == "// SPDX-License-Identifier: BSD-3-Clause" { print FILENAME }
  { nextfile }' | sort) <(sources lib procs tests) |
  violations "every source file starts with its licence line"

# 6. nothing of one machine
find . \( -path ./.git -o -path './build*' -o -path ./out -o -path ./tests/data \) -prune -o -type f -print0 |
  xargs -0 -r grep -nIE '(^|[^A-Za-z0-9_.])/(work|home|root|Users)/' /dev/null |
  grep -v '^\./tests/system/house/' |
  violations "no absolute path of one machine"

# nobody can be reached there (RFC 2606)
git ls-files 2>/dev/null | grep -v '^tests/' | search '[@.a-z-]\.(invalid|test)\b' |
  violations "no address that cannot exist"

# 7. files that can be read in one sitting
sources lib procs tests | xargs -r wc -l | awk '$2 != "total" && $1 > 600 { print $2 ": " $1 " lines" }' |
  violations "no source file over 600 lines"

# names say what is a test
sources lib procs | grep -E '_test\.[ch]pp$' | violations "no product file has a test's name"

# 8. heavy headers stay out of headers
find lib procs -name '*.hpp' | sort |
  search '#include *[<"](CLI/|opencv2/[a-bd-z]|nlohmann/json\.hpp|yaml-cpp/|mrpt/|gdal|ogr|cairo|fmt/|lcm/lcm)' |
  violations "headers include no heavy library (of OpenCV only its core)"

# 9. the top level
ls -A | grep -vE '^(CMakeLists\.txt|CMakePresets\.json|lcmtypes|procs|lib|config|scripts|tests|README\.md|LICENSE|CHANGELOG\.md|CONTRIBUTING\.md|CITATION\.cff|SECURITY\.md|\..*|build.*|out)$' |
  violations "the top level holds only what the README lists"

exit $failed

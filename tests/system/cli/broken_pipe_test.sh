#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What prints, into a reader that has had enough: the command ends at once, by the signal or well, and never leaves a
# part of what it was to write.
. "$(dirname "$0")/../bus/common.sh"
source=$2
cd "$work"
orchard="$bin/orchard"

"$orchard" simulate --scene tubes --seed 1 --out drive.lcm --truth truth.csv >/dev/null
"$orchard" map drive.lcm --out first --quiet
"$orchard" map drive.lcm --out second --quiet
head -c 100000 drive.lcm >cut.lcm

ends_well() {  # ends_well SHELL_COMMAND: into head -1, into nobody, and with its errors into nobody
  local reader streams code
  for reader in "head -n 1" true; do
    for streams in "" "2>&1"; do
      rm -rf out
      code=0
      timeout 60 bash -c "set -o pipefail; { $1 ; } $streams | $reader" >/dev/null 2>error || code=$?
      case $code in 0 | 1 | 3 | 141) ;; *) cat error; fail "exit code $code: $1 $streams | $reader" ;; esac
      if [ -e out ] && [ -n "$(find out -name '*.part' -o -name '*.tmp*')" ]; then fail "parts are left: $1"; fi
      # Whoever says that all went well has written it; a map is made in any case.
      if [ $# -gt 1 ] && { [ "$code" -eq 0 ] || [[ $1 == *" map drive.lcm"* ]]; } && ! eval "$2"; then
        cat error; fail "incomplete, exit code $code: $1 $streams | $reader"
      fi
    done
  done
  num=$((num + 1))
}
num=0

# Every command tells its use, and every program its configuration.
for command in $("$orchard" --help | sed -n 's/^  \([a-z-]*\)  .*/\1/p'); do ends_well "$orchard $command --help"; done
ends_well "$orchard --help"
[ $num -gt 15 ] || fail "only $num commands are listed"
for program in "$bin"/orchard-*; do
  case $program in *-maps | *-gis | *-calibrate | *-import) continue ;; esac
  ends_well "$program --help"
  ends_well "$program --print-config --all"
done

ends_well "$orchard simulate --scene tubes --seed 1 --out out/drive.lcm" "cmp -s drive.lcm out/drive.lcm"
ends_well "$orchard map drive.lcm --out out/map" "cmp -s first/map.csv out/map/map.csv && [ -s out/map/summary.json ]"
ends_well "$orchard map drive.lcm --out out/map --timing --quiet" "cmp -s first/map.csv out/map/map.csv"
ends_well "$orchard map cut.lcm --out out/map"
ends_well "$orchard evaluate first --truth truth.csv"
ends_well "$orchard evaluate first --truth truth.csv --json"
ends_well "$orchard compare first second --out out/changes" "[ -s out/changes/changes.csv ]"
ends_well "$orchard merge first second --out out/merged" "[ -s out/merged/map.csv ]"
ends_well "$orchard plan truth.csv"
ends_well "$orchard edit list first"
ends_well "$orchard report first --out out/report.pdf"
ends_well "$orchard export first --format gpkg --out out/map.gpkg" "[ -s out/map.gpkg ]"
for command in info "info --json" check "check --json"; do ends_well "$orchard log $command drive.lcm"; done
ends_well "$orchard log check cut.lcm"
ends_well "$orchard log config drive.lcm"
ends_well "$orchard log repair cut.lcm --out out/repaired.lcm" "[ -s out/repaired.lcm ]"
ends_well "$orchard log mcap drive.lcm --out out/drive.mcap" "[ -s out/drive.mcap ]"
ends_well "$orchard learn drive.lcm --out out/rig.yaml"
ends_well "$orchard calibrate trunks drive.lcm --config $source/config/tubes.yaml --out out/rig.yaml"
ends_well "$orchard status --once"
ends_well "$orchard doctor"
ends_well "$bin/orchard-log-player drive.lcm"
echo "ok: $num commands"

# What runs until it is stopped, too, ends when nobody reads it.
start echo.err timeout 60 bash -c "set -o pipefail; '$orchard' echo SCAN --lcm-url '$url' | head -n 1"
echo_=$started
while kill -0 "$echo_" 2>/dev/null; do
  "$bin/orchard-log-player" --config "$source/config/tubes.yaml" --speed 50 drive.lcm >/dev/null 2>&1
done
code=0; wait "$echo_" || code=$?
case $code in 0 | 141) ;; *) cat echo.err; fail "orchard echo: exit code $code" ;; esac
code=0
timeout 60 bash -c "set -o pipefail; '$orchard' live '$source/config/tubes.yaml' --sim tubes --speed 20 --out live | head -n 1" \
  >/dev/null 2>live.err || code=$?
[ "$code" -eq 0 ] || [ "$code" -eq 141 ] || { cat live.err; fail "orchard live: exit code $code"; }
[ -s live/map.csv ] || fail "orchard live ended without its map"
! pgrep -f "$work/live" >/dev/null || fail "orchard live left processes behind"
echo "ok: echo and live end with their reader"

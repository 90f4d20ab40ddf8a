#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A program that is there for a command and lacks it says so and ends, where it would otherwise run itself for ever.
set -euo pipefail
bin=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "lacking_command_test: $*" >&2; exit 1; }

try() {  # try PROGRAM: `compare`, by orchard or by orchard-maps, where the latter is orchard under its name
  local code=0
  timeout 60 "$work/$1" compare a b >"$work/out" 2>&1 || code=$?
  [ "$code" -eq 1 ] || fail "$1: exit code $code: $(cat "$work/out")"
  [ "$(wc -l <"$work/out")" -eq 1 ] || fail "$1: not one line: $(cat "$work/out")"
  grep -q "$2 lacks the command" "$work/out" || fail "$1: $(cat "$work/out")"
}
cp "$bin/orchard" "$work/orchard"
cp "$bin/orchard" "$work/orchard-maps"
try orchard orchard-maps
try orchard-maps orchard-maps
ln -sf orchard "$work/orchard-maps"
try orchard orchard-maps
try orchard-maps orchard-maps
echo "lacking_command_test: passed"

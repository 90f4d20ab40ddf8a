#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures what goes wrong in the field, on hosts that are network namespaces joined by a bridge: a bad
# link, killed processes, a full disk, hostile packets, clocks, strangers, two machines, a day.
# Prints a line for each result; exits 1 when one misses what is wanted, 77 where namespaces are
# not allowed.
#   tests/experiments/field.sh [OPTIONS] [NAME...]     measurements by name (default: all)
#     --list         names and what they measure
#     --build DIR    build folder (default build)
#     --seed N       of the drive and of everything that is drawn (default 7)
#     --speed X      of replays over a link, in times real time (default 2)
#     --num N        kills, packets (default: what the result was asked for)
#     --hours H      of the day (default 24)
#     --out DIR      where it writes (default out/field)
#     --short        seconds instead of minutes, as in ctest
#     --write        puts the lines into tests/RESULTS.md
# Needs root, python3 and a build with tests. A machine that does nothing else is wanted for the times.
set -euo pipefail
known_options="--list --build --seed --speed --num --hours --out --short --write"
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
command -v python3 >/dev/null || { echo "field: python3 is missing" >&2; exit 1; }
if [ "$(id -u)" -ne 0 ] || ! unshare -n -u true 2>/dev/null; then
  case " $* " in
    *" --list "*) ;;
    *)
      echo "field: skipped: needs root and network namespaces" >&2
      exit 77
      ;;
  esac
fi
exec python3 tests/field/field.py "$@"

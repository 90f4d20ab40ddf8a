#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Check that every source file is formatted by clang-format 14, and list those that are not.
set -euo pipefail
cd "$(dirname "$0")/.."
format=$(command -v clang-format-14 || command -v clang-format || true)
[ -n "$format" ] || { echo "format: no clang-format; apt-get install clang-format-14"; exit 77; }
case $("$format" --version) in *"version 14."*) ;; *) echo "format: not version 14, which formats differently"; exit 77 ;; esac
wrong=$(git ls-files '*.cpp' '*.hpp' | xargs "$format" --dry-run 2>&1 | sed -n 's/:[0-9]*:[0-9]*: warning.*//p' | sort -u)
if [ -n "$wrong" ]; then
  echo "$wrong" | sed 's/^/format: clang-format -i /'
  exit 1
fi
echo "format: all source files are formatted"

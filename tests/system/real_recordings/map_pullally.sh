#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Imports and maps a real drive that several tests look at, once for all of them: FOLDER/drive.lcm and
# FOLDER/map. Without the recording it makes nothing, and they skip.
#   map_pullally.sh ORCHARD SOURCE_TREE RECORDING FOLDER
set -euo pipefail
orchard=$1 source=$2 recording=$3 out=$4
rm -rf "$out"
mkdir -p "$out"
[ -d "$recording" ] || { echo "no $recording"; exit 0; }
"$orchard" import "$recording" --out "$out/drive.lcm"
"$orchard" map "$out/drive.lcm" --config "$source/config/pullally.yaml" --out "$out/map" --strict 2>"$out/errors"
[ ! -s "$out/errors" ] || { cat "$out/errors"; exit 1; }

#!/usr/bin/env bash
# Has every tree a photograph in which its trunk is in the middle? Simulated orchards of seeds 1-6 (or
# those given: FIRST LAST), easy and hard. Needs a build in build/ (or BUILD=folder).
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
build=${BUILD:-build}
mkdir -p out
for rig in orchard orchard_hard; do
  echo "config/$rig.yaml"
  "$build/experiments/album_seeds" "config/$rig.yaml" "${1:-1}" "${2:-6}"
done | tee out/album_seeds.txt

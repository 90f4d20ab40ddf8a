#!/usr/bin/env bash
# Maps the paper's tube scene over seeds 1-100 (or those given: FIRST LAST) and prints the
# distributions beside the paper's tables 1 and 2. With --calibrate the trunk model is first measured
# anew on seeds 1001-1020, as config/tubes.yaml's was. Needs a build in build/ (or BUILD=folder).
set -euo pipefail
known_options="--calibrate"
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
build=${BUILD:-build}
config=config/tubes.yaml
if [ "${1:-}" = --calibrate ]; then
  shift
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
  logs=()
  for seed in $(seq 1001 1020); do
    logs+=("$folder/tubes_$seed.lcm")
    "$build/bin/orchard" simulate --scene tubes --seed "$seed" --config "$config" \
      --out "$folder/tubes_$seed.lcm" >/dev/null
  done
  "$build/bin/orchard" calibrate trunks "${logs[@]}" --colour-model hue_interval --config "$config" --out "$folder/tubes.yaml" |
    tail -n 12
  config=$folder/tubes.yaml
fi
mkdir -p out
"$build/experiments/tube_seeds" "$config" "${1:-1}" "${2:-100}" | tee out/tube_seeds.txt

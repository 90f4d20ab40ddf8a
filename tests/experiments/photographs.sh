#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Area under the ROC curve of a model learnt from photographs of a cherry orchard (cherry_trunks of
# ../shared/data, or PHOTOGRAPHS=folder) on photographs of other trees, at other exposures and lights.
#   tests/experiments/photographs.sh [LEARNT JUDGED]...    such as 000-019 020-119 (the default)
# EXPOSURES="0 -2 -1 1 2" [EV]  GAINS="1:1 1.23:0.69 0.87:1.12" (red:blue)
# Needs a build in build/ (or BUILD=folder).
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
orchard=${BUILD:-build}/bin/orchard
data=${PHOTOGRAPHS:-../shared/data/cherry_trunks}
out=${OUT:-out/photographs}
mkdir -p "$out"
[ $# -gt 0 ] || set -- 000-019 020-119
area() {  # JUDGED MODEL OPTIONS...
  local judged=$1 model=$2
  shift 2
  "${BUILD:-build}/experiments/evaluate_windows" --images "$data/images" --masks "$data/masks" --model "$model" --only "$judged" \
    "$@" 2>/dev/null | awk '$1 == "auc" { print $2; exit }'
}
while [ $# -gt 1 ]; do
  model=$out/model_$1.yaml
  "$orchard" calibrate trunks --images "$data/images" --masks "$data/masks" --only "$1" --out "$model" >/dev/null 2>&1
  printf 'learnt from %s, judged on %s:\n' "$1" "$2"
  for ev in ${EXPOSURES:-0 -2 -1 1 2}; do
    printf '  %+d EV %s\n' "$ev" "$(area "$2" "$model" --exposure "$ev")"
  done
  for gains in ${GAINS:-}; do
    printf '  red x %s, blue x %s: %s\n' "${gains%:*}" "${gains#*:}" \
      "$(area "$2" "$model" --red-gain "${gains%:*}" --blue-gain "${gains#*:}")"
  done
  shift 2
done

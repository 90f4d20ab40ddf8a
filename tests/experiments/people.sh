#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What three people about, who walk ahead, beside and behind the robot or stand until it is past,
# leave in the map of a laser alone: over seeds 1-20 (or FIRST LAST) whole drives of the easy orchard,
# or the first minute of each. Prints landmarks where nothing of the truth stands, and what was kept
# of what does.
#   SECONDS_PER_DRIVE=60  OUT=out/people  BUILD=build
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
orchard=${BUILD:-build}/bin/orchard
out=${OUT:-out/people}
mkdir -p "$out"
sed -e 's/^simulation:/&\n  clutter:\n    num_people: 3\n    people_around: true/' \
  -e '/^camera:/,/enabled/ s/enabled: true/enabled: false/' config/orchard.yaml >"$out/rig.yaml"

for seed in $(seq "${1:-1}" "${2:-20}"); do
  stem=$out/$seed
  if [ ! -s "$stem.lcm" ]; then
    nice -n 10 "$orchard" simulate --scene orchard --seed "$seed" --config "$out/rig.yaml" \
      ${SECONDS_PER_DRIVE:+--duration "$SECONDS_PER_DRIVE"} --out "$stem.part.lcm" --truth "$stem.truth.csv" >/dev/null
    mv "$stem.part.lcm" "$stem.lcm"
  fi
  nice -n 10 "$orchard" map "$stem.lcm" --config "$out/rig.yaml" --out "$stem" --quiet
done

python3 - "$out" "${1:-1}" "${2:-20}" <<'PYTHON' | tee "$out/table.txt"
import csv, math, sys
def read(path):
    return [(r['class'], float(r['x_m']), float(r['y_m']), float(r['width_m']), int(r.get('n', 0)))
            for r in csv.DictReader(open(path))]
apart = lambda a, b: math.hypot(a[1] - b[1], a[2] - b[2])
often = seldom = trees = found = things = kept = 0
for seed in range(int(sys.argv[2]), int(sys.argv[3]) + 1):
    truth = read(f'{sys.argv[1]}/{seed}.truth.csv')
    marks = read(f'{sys.argv[1]}/{seed}/map.csv')
    extra = [m for m in marks if not any(apart(m, t) < 0.3 + t[3] / 2 for t in truth)]
    often_here = sum(m[4] >= 4 for m in extra)
    print(f'seed {seed}: seen four times or more {often_here}, less {len(extra) - often_here}')
    often += often_here
    seldom += len(extra) - often_here
    for t in truth:
        if not any(apart(m, t) < 3 for m in marks):
            continue
        is_tree = t[0] == 'tree'
        trees += is_tree
        things += not is_tree
        found += is_tree and any(m[0] == 'tree' and apart(m, t) < 0.3 for m in marks)
        kept += not is_tree and any(apart(m, t) < 0.3 + t[3] / 2 for m in marks)
print(f'all: {often} seen four times or more, {seldom} less; trees {found} of {trees}, '
      f'other things {kept} of {things}')
PYTHON

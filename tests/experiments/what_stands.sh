#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What becomes of leafy bushes, of people beside and behind the robot, and of ways: over seeds 1-6
# (or FIRST LAST) the hard orchard with leaves that beams go 0.15 m into, and the easy one with three
# people about. Prints landmarks per map and within bushes, those where nothing of the truth stands,
# trees found, how near a way of graph.json comes to any landmark's rim, and at the end the F1 of the
# trees among the leafy bushes.
#   SECONDS_PER_DRIVE=45  OUT=out/stands  BUILD=build  LEAF_M=0.15  WHAT="leafy people"
set -euo pipefail
. "$(dirname "$0")/../script_help.sh"
cd "$(dirname "$0")/../.."
orchard=${BUILD:-build}/bin/orchard
first=${1:-1} last=${2:-6}
out=${OUT:-out/stands}
mkdir -p "$out"
rm -f "$out/table.txt"
sed "s/^  clutter:/&\n    leaf_depth_m: ${LEAF_M:-0.15}/" config/orchard_hard.yaml >"$out/leafy.yaml"
sed 's/^simulation:/&\n  clutter:\n    num_people: 3\n    people_around: true/' config/orchard.yaml \
  >"$out/people.yaml"

# score TRUTH MAP: the figures of one map; a bush is an object with a name of its own width only,
# so whatever is 0.4 to 0.8 m wide and no crate counts as one
score() {
  python3 - "$1" "$2" <<'PYTHON'
import csv, json, math, sys
def read(path):
    return [(r['class'], float(r['x_m']), float(r['y_m']), float(r['width_m']))
            for r in csv.DictReader(open(path))]
truth, marks = read(sys.argv[1]), read(sys.argv[2] + '/map.csv')
apart = lambda a, b: math.hypot(a[1] - b[1], a[2] - b[2])
def to_way(p, a, b):
    dx, dy = b[0] - a[0], b[1] - a[1]
    t = max(0.0, min(1.0, ((p[1] - a[0]) * dx + (p[2] - a[1]) * dy) / max(1e-12, dx * dx + dy * dy)))
    return math.hypot(p[1] - a[0] - t * dx, p[2] - a[1] - t * dy)
trees = [t for t in truth if t[0] == 'tree' and any(apart(m, t) < 3 for m in marks)]
found = sum(any(m[0] == 'tree' and apart(m, t) < 0.3 for m in marks) for t in trees)
false = sum(m[0] == 'tree' and not any(t[0] == 'tree' and apart(m, t) < 0.3 for t in truth) for m in marks)
extra = sum(not any(apart(m, t) < 0.3 + t[3] / 2 for t in truth) for m in marks)
bushes = [t for t in truth if t[0] == 'object' and 0.4 <= t[3] <= 0.8 and t[3] not in (0.4, 0.6)]
within = [sum(m[0] != 'tree' and apart(m, t) < t[3] / 2 for m in marks) for t in bushes]
ways = json.load(open(sys.argv[2] + '/graph.json'))['edges']
nearest = min((to_way(m, w['line'][i - 1], w['line'][i]) - m[3] / 2
               for w in ways for m in marks for i in range(1, len(w['line']))), default=math.inf)
print(f'{len(marks)} landmarks; in bushes {within}; extra {extra}; trees {found} of {len(trees)}, '
      f'false {false}; {len(ways)} ways, nearest rim {nearest:.2f} m')
PYTHON
}

leafy=() looks=() truths=()
for seed in $(seq "$first" "$last"); do
  for what in ${WHAT:-leafy people}; do
    stem=$out/${what}_$seed
    if [ ! -s "$stem.lcm" ]; then
      nice -n 10 "$orchard" simulate --scene orchard --seed "$seed" --config "$out/$what.yaml" \
        --duration "${SECONDS_PER_DRIVE:-45}" --out "$stem.part.lcm" --truth "$stem.truth.csv" >/dev/null
      "${BUILD:-build}/experiments/true_observations" --scene orchard --seed "$seed" --config "$out/$what.yaml" \
        --duration "${SECONDS_PER_DRIVE:-45}" --out "$stem.looks.csv" >/dev/null
      mv "$stem.part.lcm" "$stem.lcm"
    fi
    nice -n 10 "$orchard" map "$stem.lcm" --config "$out/$what.yaml" --out "$stem" --quiet
    echo "$what $seed: $(score "$stem.truth.csv" "$stem")" | tee -a "$out/table.txt"
    [ "$what" = leafy ] || continue
    leafy+=("$stem") looks+=("$stem.looks.csv") truths+=("$stem.truth.csv")
  done
done
[ ${#leafy[@]} -eq 0 ] || "${BUILD:-build}/experiments/evaluate_detections" "${leafy[@]}" --observations "${looks[@]}" \
  --truth "${truths[@]}" | sed -n '3,5p' | tee -a "$out/table.txt"

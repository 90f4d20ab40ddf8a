#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares a map of a pullally_drive recording with where its trunks pile up.

usage: scripts/pullally_check.py RECORDING_FOLDER MAP_FOLDER

Independent of the mapper: cuts the raw scans at range jumps, keeps what is narrow and stands free,
puts it where the recording's track says, and climbs to the peaks of its density (Gaussian, 0.15 m).
Peaks at least 1 m apart that 15 or more observations support are the clear trees.
"""
import csv
import gzip
import math
import sys
from collections import defaultdict

BEARING_MIN_RAD, BEARING_STEP_RAD = -3.141592654, 0.006996866
KERNEL_M, CELL_M, CLEAR = 0.15, 0.5, 15.0


def observations(folder):
    with open(folder + "/poses.csv") as file:
        poses = {r["utime_us"]: [float(r[k]) for k in ("x_m", "y_m", "yaw_rad")]
                 for r in csv.DictReader(file)}
    with gzip.open(folder + "/scans.csv.gz", "rt") as file:
        next(file)
        for line in file:
            utime, *ranges = line.rstrip().split(",")
            if utime not in poses:
                continue
            x, y, yaw = poses[utime]
            r, i = [float(v) for v in ranges], 0
            while i < len(r):
                j = i
                while j + 1 < len(r) and r[j + 1] > 0 and abs(r[j + 1] - r[j]) < 0.25:
                    j += 1
                mean = sum(r[i:j + 1]) / (j - i + 1)
                width = mean * (j - i + 1) * BEARING_STEP_RAD
                bearing = BEARING_MIN_RAD + 0.5 * (i + j) * BEARING_STEP_RAD
                free = (0 < i < j < len(r) - 1 and (r[i - 1] == 0 or r[i - 1] > mean)
                        and (r[j + 1] == 0 or r[j + 1] > mean))
                if free and 0.9 < mean < 7 and abs(bearing) < 2.44 and 0.08 < width < 0.40:
                    centre = mean + 0.5 * width
                    yield (x + centre * math.cos(yaw + bearing), y + centre * math.sin(yaw + bearing))
                i = j + 1


def peaks(points):
    cells = defaultdict(list)
    for x, y in points:
        cells[int(x // CELL_M), int(y // CELL_M)].append((x, y))
    found = []
    for x, y in points:
        for _ in range(15):
            total = sum_x = sum_y = 0.0
            cx, cy = int(x // CELL_M), int(y // CELL_M)
            for a in range(cx - 1, cx + 2):
                for b in range(cy - 1, cy + 2):
                    for px, py in cells.get((a, b), ()):
                        weight = math.exp(-((px - x)**2 + (py - y)**2) / (2 * KERNEL_M**2))
                        total += weight
                        sum_x += weight * px
                        sum_y += weight * py
            x, y = sum_x / total, sum_y / total
        found.append((total, x, y))
    found.sort(reverse=True)
    apart = []
    for total, x, y in found:
        if total >= CLEAR and all(math.hypot(x - p[1], y - p[2]) > 1.0 for p in apart):
            apart.append((total, x, y))
    return apart


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[2] + "/map.csv") as file:
        trees = [(float(r["x_m"]), float(r["y_m"])) for r in csv.DictReader(file)
                 if r["class"] == "tree" and int(r["n"]) >= 10]
    clear = peaks(list(observations(sys.argv[1])))
    hits = [sorted(d for t in trees if (d := math.dist(t, p[1:])) < 0.5) for p in clear]
    once = sorted(h[0] for h in hits if len(h) == 1)
    print(f"clear trees: {len(clear)}; with one tree landmark: {len(once)}, "
          f"none: {sum(not h for h in hits)}, more: {sum(len(h) > 1 for h in hits)}")
    if once:
        print(f"distance to the peak: median {once[len(once) // 2]:.3f} m, most {once[-1]:.3f} m")
    print(f"tree landmarks seen ten times or more: {len(trees)}")
    for p, h in zip(clear, hits):
        if len(h) != 1:
            print(f"  ({p[1]:.2f}, {p[2]:.2f}), support {p[0]:.0f}: {len(h)} landmarks")


main()

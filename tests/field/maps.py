# SPDX-License-Identifier: BSD-3-Clause
"""Compares two map.csv: what is gone, new, called otherwise, or has another id."""
import csv
import math

NEAR_m = 0.2


def rows(path):
    with open(path) as file:
        return [{**row, "x": float(row["x_m"]), "y": float(row["y_m"])} for row in csv.DictReader(file)]


def trees(path):
    return [row for row in rows(path) if row["class"] == "tree"]


def nearest(row, others):
    best = min(others, key=lambda o: math.hypot(o["x"] - row["x"], o["y"] - row["y"]), default=None)
    if best is None or math.hypot(best["x"] - row["x"], best["y"] - row["y"]) > NEAR_m:
        return None
    return best


class Difference:
    """What another map has otherwise than a first one, in trees."""

    def __init__(self, first, other):
        a, b = trees(first), trees(other)
        self.num, self.num_other = len(a), len(b)
        self.gone = sum(nearest(row, b) is None for row in a)
        self.new = sum(nearest(row, a) is None for row in b)
        pairs = [(row, nearest(row, b)) for row in a if nearest(row, b)]
        self.other_id = sum(row["id"] != match["id"] for row, match in pairs)
        offsets = [math.hypot(r["x"] - m["x"], r["y"] - m["y"]) for r, m in pairs]
        self.offset_most_mm = 1e3 * max(offsets, default=0.0)
        with open(first, "rb") as one, open(other, "rb") as two:
            self.same_bytes = one.read() == two.read()

    def percent(self):
        return 100.0 * (self.gone + self.new) / max(1, self.num)

    def __str__(self):
        if self.same_bytes:
            return f"the same bytes ({self.num} trees)"
        return (f"{self.gone} gone, {self.new} new of {self.num} trees ({self.percent():.1f} %), "
                f"offset at most {self.offset_most_mm:.0f} mm")


class Total:
    """What several pairs of maps have otherwise, together."""

    def __init__(self, differences):
        self.num = self.gone = self.new = 0
        self.offset_most_mm = 0.0
        for difference in differences:
            self.num += difference.num
            self.gone += difference.gone
            self.new += difference.new
            self.offset_most_mm = max(self.offset_most_mm, difference.offset_most_mm)

    def __str__(self):
        return (f"{self.gone} gone, {self.new} new of {self.num} trees "
                f"({100.0 * (self.gone + self.new) / max(1, self.num):.1f} %), "
                f"offset at most {self.offset_most_mm:.0f} mm")

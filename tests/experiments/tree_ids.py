#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints the landmarks of a map that a person who knows the trees would pick: tree_ids.py TRUTH.csv MAP.csv"""
import csv
import math
import sys

trees = [(float(row["x_m"]), float(row["y_m"])) for row in csv.DictReader(open(sys.argv[1]))
         if row["class"] == "tree"]
marks = [(row["id"], float(row["x_m"]), float(row["y_m"])) for row in csv.DictReader(open(sys.argv[2]))]
picked = set()
for x_m, y_m in trees:
    away_m, which = min((math.hypot(mark[1] - x_m, mark[2] - y_m), mark[0]) for mark in marks)
    if away_m < 0.3:
        picked.add(which)
print(",".join(sorted(picked, key=int)))

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What a growth of trunks can be known to, against how well two maps know it.

usage: growth_bound.py BEFORE AFTER    (of each drive: FOLDER/map.csv, FOLDER.csv, FOLDER.looks.csv)

Prints `growth,TREES,SUM_OF_ERRORS_M,SUM_OF_SQUARED_ERRORS_M2,SUM_OF_BOUNDS_M2`: the error of each
tree's width difference, and the Cramer-Rao bound of its variance. A look at an unhidden trunk of n
beam steps d counts beams whose phase is not known, so its width has a variance of d2 / 6, besides the
noise of the ranges that make an angle a width (config/block.yaml's scanner).
"""
import csv
import math
import sys

BEAM_STEP_RAD = 2 * math.pi / 1024
BEAM_SD_M, BEAM_SD, SCAN_SD = 0.003, 0.003, 0.004  # simulation.scanner's defaults
RANGE_MAX_M = 10.0  # detector.segmentation.range_max_m


def read(path):
    with open(path) as file:
        return list(csv.DictReader(file))


def place(row):
    return float(row['x_m']), float(row['y_m'])


def information(stem):
    """1 / m2 of each tree's width, by its line in the truth."""
    of_tree = {}
    with open(stem + '.looks.csv') as file:
        for look in csv.DictReader(file):
            if look['class'] != 'tree' or float(look['hidden_fraction']) > 0:
                continue
            range_m, width_m = float(look['range_m']), float(look['width_m'])
            if range_m > RANGE_MAX_M:
                continue
            step_m = (range_m + 0.5 * width_m) * BEAM_STEP_RAD
            beam_sd = (BEAM_SD_M + BEAM_SD * range_m) / range_m
            variance_m2 = (step_m ** 2 / 6 + width_m ** 2 *
                           (beam_sd ** 2 / max(1.0, width_m / step_m) + SCAN_SD ** 2))
            key = int(look['object'])
            of_tree[key] = of_tree.get(key, 0.0) + 1 / variance_m2
    return of_tree


def nearest(row, others, within_m):
    apart = lambda other: math.dist(place(row), place(other))
    best = min(others, key=apart, default=None)
    return best if best is not None and apart(best) < within_m else None


def main():
    stems = sys.argv[1:3]
    truths = [read(stem + '.csv') for stem in stems]
    maps = [[m for m in read(stem + '/map.csv') if m['class'] == 'tree'] for stem in stems]
    known = [information(stem) for stem in stems]
    later_trees = [t for t in truths[1] if t['class'] == 'tree']
    num, errors_m, squares_m2, bounds_m2 = 0, 0.0, 0.0, 0.0
    for i, tree in enumerate(truths[0]):
        later = nearest(tree, later_trees, 0.02) if tree['class'] == 'tree' else None
        marks = [nearest(tree, m, 0.3) for m in maps]
        if later is None or None in marks:
            continue
        k = truths[1].index(later)
        if i not in known[0] or k not in known[1]:
            continue
        error_m = (float(marks[1]['width_m']) - float(marks[0]['width_m']) -
                   float(later['width_m']) + float(tree['width_m']))
        num += 1
        errors_m += error_m
        squares_m2 += error_m ** 2
        bounds_m2 += 1 / known[0][i] + 1 / known[1][k]
    print(f'growth,{num},{errors_m:.6g},{squares_m2:.6g},{bounds_m2:.6g}')


main()

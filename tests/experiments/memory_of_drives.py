#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Memory against distance of long drives, as a picture and in figures.

Each drive is three files of `scale.sh`: what `orchard map --timing` printed, the true poses, and the map.
Prints the most memory up to each tenth of the drive and the growth per kilometre beyond the first
thousand scans, less 2 kiB per tree of the map. Needs Debian's python3-matplotlib for the picture.

usage: tests/experiments/memory_of_drives.py PICTURE.png NAME=PRINTED.txt,POSES.csv,MAP.csv ...
"""
import csv
import math
import re
import sys

WANTED_MIB_PER_KM, WANTED_KIB_PER_TREE = 5.0, 2.0


def read_path(name):
    """Seconds since the first pose, and kilometres driven until then."""
    seconds, km = [], []
    with open(name) as file:
        for row in csv.DictReader(file):
            at = [float(v) for v in list(row.values())[:3]]
            if seconds:
                km.append(km[-1] + math.dist(at[1:], before[1:]) / 1000)
            else:
                first, km = at[0], [0.0]
            seconds.append((at[0] - first) / 1e6)
            before = at
    return seconds, km


def read_drive(printed, poses, trees):
    """Kilometres and most memory so far [MiB] after each thousand scans; trees in the map."""
    seconds, km = read_path(poses)
    ends, most_mib = [], []
    with open(printed) as file:
        for line in file:
            found = re.match(r"timing: scans \d+-(\d+): .* ms a scan, ([\d.]+) MiB", line)
            if found:
                ends.append(int(found[1]))
                most_mib.append(float(found[2]))
    with open(trees) as file:
        num_trees = sum(1 for _ in file) - 1
    place = [km[min(len(km) - 1, round(end / ends[-1] * (len(km) - 1)))] for end in ends]
    return place, most_mib, num_trees


def main():
    if len(sys.argv) < 3 or sys.argv[1] in ("-h", "--help"):
        print(__doc__)
        return 0 if len(sys.argv) > 1 else 2
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(figsize=(8, 4.5))
    for argument in sys.argv[2:]:
        name, files = argument.split("=", 1)
        km, mib, num_trees = read_drive(*files.split(","))
        line, = axes.plot(km, mib, label=name)
        allowed = mib[0] + WANTED_MIB_PER_KM * (km[-1] - km[0]) + WANTED_KIB_PER_TREE * num_trees / 1024
        axes.plot([km[0], km[-1]], [mib[0], allowed], "--", color=line.get_color(), linewidth=0.8,
                  label=f"{name}: 5 MiB per km and 2 kiB per tree")
        tenths = [mib[round(i * (len(mib) - 1) / 10)] for i in range(11)]
        print(f"{name}: {km[-1]:.1f} km, {num_trees} trees; most memory by tenths of the drive: "
              + " ".join(f"{m:.0f}" for m in tenths) + " MiB")
        growth_mib = mib[-1] - mib[0]
        print(f"{name}: {growth_mib / (km[-1] - km[0]):.2f} MiB per km in all; less 2 kiB per tree "
              f"{(growth_mib - WANTED_KIB_PER_TREE * num_trees / 1024) / (km[-1] - km[0]):.2f} (wanted: 5)")
    axes.set_xlabel("driven [km]")
    axes.set_ylabel("most memory so far [MiB]")
    axes.set_ylim(bottom=0)
    axes.legend(fontsize="small")
    figure.tight_layout()
    figure.savefig(sys.argv[1], dpi=110, metadata={"Software": None})
    return 0


if __name__ == "__main__":
    sys.exit(main())

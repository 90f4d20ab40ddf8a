#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""plan_files.py [FIRST LAST]: is a grower's plan in another coordinate system laid right on maps of random orchards?

Seeds 1 to 50, by the real files: PROJ puts the plan (rows and trees with names) into UTM, Web Mercator, GDA2020, ETRS89, Lambert 93
or WGS 84, GDAL writes it as GeoJSON, GeoPackage, Shapefile, KML or CSV, and `orchard plan FILE --map MAP --out DIR` lays it on a map
on the earth, 0.7 m and a quarter of a degree off, turned as its drive began. 5 % of the trees are missing, 2 % are extra, one row is
shifted. Prints whether every name is right, and precision and recall of what is found. Needs a build in build/ (or BUILD=folder).
"""
import csv
import json
import math
import os
import random
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, ROOT + "/tests/system")
import maps  # noqa: E402

ORCHARD = os.environ.get("BUILD", ROOT + "/build") + "/bin/orchard"
# Where the system is at home: latitude and longitude.
SYSTEMS = {"EPSG:32719": (-33.4, -70.6), "EPSG:3857": (47.6, 9.4), "EPSG:7856": (-27.6, 151.9), "EPSG:25830": (41.6, -0.9),
           "EPSG:2154": (44.0, 1.3), "EPSG:4326": (36.7, -119.8), "EPSG:32633": (46.5, 15.1)}
# What each format holds of systems; KML is WGS 84 alone.
FORMATS = {"geojson": "GeoJSON", "gpkg": "GPKG", "shp": "ESRI Shapefile", "csv": "CSV", "kml": "KML"}
REACH_M = 8.0
EXTRA, MISSING, MOVED = 0.02, 0.05, 0.4


def plant(dice):
    """Trees of the plan by (row, tree) at east and north [m], and those that stand: name or None, east, north."""
    num_rows, num_trees = dice.randint(6, 14), dice.randint(12, 25)
    spacing, apart, bearing = dice.uniform(2.5, 4), dice.uniform(4, 5.5), dice.uniform(0, 2 * math.pi)
    first = dice.randint(1, 40)
    along, aside = (math.cos(bearing), math.sin(bearing)), (-math.sin(bearing), math.cos(bearing))

    def at(k, row, more_along=0.0, more_aside=0.0):
        u, v = k * spacing + more_along, row * apart + more_aside
        return u * along[0] + v * aside[0], u * along[1] + v * aside[1]

    # Rows are not equally long: a rectangle would be its own image.
    ends = [num_trees - dice.randint(0, 4) for _ in range(num_rows)]
    plan = {(str(first + r), str(k + 1)): at(k, r, dice.gauss(0, 0.05), dice.gauss(0, 0.05))
            for r in range(num_rows) for k in range(ends[r])}
    shifted = str(first + dice.randrange(num_rows))
    shift = dice.uniform(0.2, MOVED) * spacing * dice.choice((-1, 1))
    missing = set(dice.sample(sorted(plan), round(MISSING * len(plan))))
    standing = []
    for name, (east, north) in plan.items():
        if name in missing:
            continue
        if name[0] == shifted:
            east, north = east + shift * along[0], north + shift * along[1]
        standing.append((name, east, north))
    for _ in range(round(EXTRA * len(plan))):
        r = dice.randrange(num_rows)
        k = dice.randrange(ends[r] - 1)
        more = shift if str(first + r) == shifted else 0.0
        standing.append((None, *at(k + 0.5, r, more, dice.uniform(-0.3, 0.3))))
    # Along each aisle and outside of the first and the last row.
    way = []
    for r in range(num_rows + 1):
        steps = range(-8, num_trees * 4 + 8)
        way += [at(k / 4, r - 0.5) for k in (steps if r % 2 == 0 else reversed(steps))]
    return plan, standing, missing, shifted, way


def write_plan(plan, place, system, word, folder, local):
    features = [{"type": "Feature", "geometry": {"type": "Point", "coordinates": xy}, "properties": {"row": row, "tree": tree}}
                for (row, tree), xy in plan.items()]
    with open(folder + "/local.geojson", "w", encoding="ascii") as file:
        json.dump({"type": "FeatureCollection", "features": features}, file)
    path = f"{folder}/plan.{word}"
    # As an office makes it: RFC 7946 would turn all GeoJSON into WGS 84.
    more = {"geojson": ["-lco", "RFC7946=NO", "-lco", "COORDINATE_PRECISION=9"], "csv": ["-lco", "GEOMETRY=AS_XY"]}.get(word, [])
    subprocess.run(["ogr2ogr", "-f", FORMATS[word], path, folder + "/local.geojson", "-s_srs", local, "-t_srs", system, "-nln",
                    "trees", *more], check=True, stderr=subprocess.DEVNULL)
    if word == "csv":  # a table names no system: who gives it says which
        with open(path, encoding="ascii") as file:
            text = file.read()
        names = "longitude,latitude" if system == "EPSG:4326" else "x,y"
        with open(path, "w", encoding="ascii") as file:
            file.write(names + text[text.index(","):][2:])
    return path, ["--crs", system] if word == "csv" and system != "EPSG:4326" else []


def write_map(standing, way, place, dice, folder):
    """The map, in its own frame; which landmark is which tree. It believes to lie 0.7 m and a quarter of a degree elsewhere."""
    yaw, x0, y0 = dice.uniform(-3, 3), dice.uniform(-50, 50), dice.uniform(-50, 50)

    def in_map(east, north, noise=0.0):
        u, v = east - x0, north - y0
        return (u * math.cos(yaw) + v * math.sin(yaw) + dice.gauss(0, noise), -u * math.sin(yaw) + v * math.cos(yaw) + dice.gauss(0, noise))

    names = {}
    dice.shuffle(standing)
    lines = []
    for i, (name, east, north) in enumerate(standing):
        names[i + 1] = name
        lines.append(maps.landmark(i + 1, *in_map(east, north, 0.03), width_m=dice.gauss(0.12, 0.012)))
    path = [(*in_map(*a), math.remainder(math.atan2(b[1] - a[1], b[0] - a[0]) - yaw, 2 * math.pi)) for a, b in zip(way, way[1:])]
    maps.write_map(folder, lines, path, maps.datum(place[0], place[1], dice.uniform(0, 700), x_m=x0 + dice.gauss(0, 0.7),
                                                   y_m=y0 + dice.gauss(0, 0.7), yaw_rad=yaw + dice.gauss(0, 0.005)), period_us=500000,
                   view={"reach_m": REACH_M, "bearing_min_rad": -2.356, "bearing_max_rad": 2.356, "mount_x_m": 0.3, "mount_y_m": 0.0,
                         "mount_yaw_rad": 0.0, "min_observations": 1})
    return names


def rows_of(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def trial(seed):
    dice = random.Random(seed)
    word = list(FORMATS)[seed % len(FORMATS)]
    system = "EPSG:4326" if word == "kml" else list(SYSTEMS)[seed % len(SYSTEMS)]
    latitude, longitude = SYSTEMS[system]
    place = (latitude + dice.uniform(-0.3, 0.3), longitude + dice.uniform(-0.3, 0.3))
    plan, standing, missing, shifted, way = plant(dice)
    with tempfile.TemporaryDirectory() as folder:
        local = f"+proj=tmerc +lat_0={place[0]} +lon_0={place[1]} +k=1 +datum=WGS84 +units=m"
        path, more = write_plan(plan, place, system, word, folder, local)
        names = write_map(standing, way, place, dice, folder + "/map")
        done = subprocess.run([ORCHARD, "plan", path, *more, "--map", folder + "/map", "--out", folder + "/named"], capture_output=True,
                              text=True, check=False)
        if done.returncode != 0:
            print(f"seed {seed}: {word} in {system}: refused: {done.stderr.strip()}")
            return None
        given = {int(row["id"]): (row["row"], row["tree"]) for row in rows_of(folder + "/named/names.csv") if row["tree"]}
        found = set()
        for row in rows_of(folder + "/named/plan.csv"):
            if row["deviation"] == "missing":
                found.add(("missing", row["row"], row["tree"]))
            elif row["deviation"] == "extra":
                found.add(("extra", int(row["id"])))
            elif row["deviation"] == "out_of_place":
                found.add(("out_of_place", int(row["id"])))
        found |= {("shifted", row["row"]) for row in rows_of(folder + "/named/plan_rows.csv") if row["shifted"] not in ("", "0", "no", "false")}
    truth = {("missing", *name) for name in missing} | {("extra", i) for i, name in names.items() if name is None} | {("shifted", shifted)}
    wrong = [i for i, name in names.items() if given.get(i) != name]
    print(f"seed {seed}: {word} in {system}: {len(plan)} planned, {len(names) - len(wrong)} of {len(names)} names right; deviations "
          f"{len(found & truth)} found, {len(found - truth)} false, {len(truth - found)} overlooked", flush=True)
    return len(names), len(wrong), len(found & truth), len(found - truth), len(truth - found)


def main():
    if len(sys.argv) > 1 and sys.argv[1] in ("-h", "--help"):
        print(__doc__)
        return
    first, last = (int(sys.argv[1]), int(sys.argv[2])) if len(sys.argv) > 2 else (1, 50)
    trials = [trial(seed) for seed in range(first, last + 1)]
    laid = [t for t in trials if t]
    names, wrong, hits, false, overlooked = (sum(t[k] for t in laid) for k in range(5))
    print(f"{len(trials)} orchards, {len(laid)} laid, {sum(t[1] > 0 for t in laid)} with a wrong name; {names - wrong} of {names} names right; "
          f"deviations: precision {hits / (hits + false):.4f}, recall {hits / (hits + overlooked):.4f}")


if __name__ == "__main__":
    main()

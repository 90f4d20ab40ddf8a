# SPDX-License-Identifier: BSD-3-Clause
"""One drive has one map. Of the map of a real drive (real_recordings/map_pullally.sh) map.csv and graph.json are
compared with everything else that shows the map, each read by a program that is not ours: GDAL, the
csv and json modules, and the Python types that lcm-gen makes.
Usage: one_map_test.py BUILD SOURCE PULLALLY, the folder that map_pullally.sh has made."""
import csv
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, HERE + "/../publish"]
import server as postgres  # noqa: E402
from lcm_log import events  # noqa: E402

BUILD, SOURCE, PULLALLY = sys.argv[1:4]
FIELDS_OF_ROW = ("row", "trees", "gaps")


def run(*arguments):
    return subprocess.run([BUILD + "/bin/orchard", *arguments], check=True, text=True,
                          stdout=subprocess.PIPE).stdout


def table(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def layer(path, name):
    """The features of a layer as dictionaries, with their lines in the map frame left out."""
    text = subprocess.run(["ogr2ogr", "-f", "CSV", "/vsistdout/", path, name], check=True, text=True,
                          stdout=subprocess.PIPE).stdout
    return list(csv.DictReader(text.splitlines()))


def rows_of(numbers):
    """Row -> number of its trees and positions of its gaps, from {id: (row, position)}."""
    rows = {}
    for row, position in numbers.values():
        if row:
            rows.setdefault(row, []).append(position)
    gaps = {row: sorted(set(range(min(p), max(p) + 1)) - set(p)) for row, p in rows.items()}
    return {row: (len(p), gaps[row]) for row, p in sorted(rows.items())}


def whole(text):
    return int(text) if text else 0


class OneMap(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="orchard_one_map_")
        cls.map = shutil.copytree(PULLALLY + "/map", cls.folder + "/map")
        cls.numbers = {int(t["id"]): (whole(t["row"]), whole(t["position"]))
                       for t in table(cls.map + "/map.csv")}
        cls.rows = rows_of(cls.numbers)
        with open(cls.map + "/graph.json") as file:
            edges = json.load(file)["edges"]
        cls.ways = sorted((e["kind"], e.get("row_left", e.get("row")), e.get("row_right", 0),
                           *cls.size_of(e)) for e in edges)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def test_there_is_something_to_agree_on(self):
        self.assertEqual(len(self.rows), 5)
        self.assertGreater(len(self.ways), 4)

    def check_layers(self, source):
        rows = {int(r["row"]): (int(r["trees"]), int(r["gaps"])) for r in source("rows")}
        self.assertEqual(rows, {row: (n, len(gaps)) for row, (n, gaps) in self.rows.items()})
        gaps = sorted((int(g["row"]), int(g["position"])) for g in source("gaps"))
        self.assertEqual(gaps, [(r, g) for r, (_, gaps) in self.rows.items() for g in gaps])
        numbers = {int(l["id"]): (whole(l["row"]), whole(l["position"])) for l in source("landmarks")}
        self.assertEqual(numbers, self.numbers)
        ways = [("aisle", int(w["row_left"]), int(w["row_right"])) + self.size_of(w)
                for w in source("aisles")]
        ways += [("headland", int(w["row"]), 0) + self.size_of(w) for w in source("headlands")]
        self.check_ways(ways)

    @staticmethod
    def size_of(way):
        return float(way["width_m"]), float(way["length_m"])

    def check_ways(self, ways):
        self.assertEqual([way[:3] for way in sorted(ways)], [way[:3] for way in self.ways])
        for way, told in zip(sorted(ways), self.ways):
            for size_m, told_m in zip(way[3:], told[3:]):  # files round to millimetres
                self.assertLess(abs(size_m - told_m), 1.1e-3, way)

    def test_map_gpkg(self):
        self.check_layers(lambda name: layer(self.map + "/map.gpkg", name))

    def export(self, *more):
        path = self.folder + "/exported.gpkg"
        run("export", self.map, "--format", "gpkg", "--out", path, "--overwrite", *more)
        return path

    def test_export(self):
        path = self.export()
        self.check_layers(lambda name: layer(path, name))

    def test_map_html(self):
        with open(self.map + "/map.html") as file:
            text = file.read()
        self.check_page(*(json.JSONDecoder().raw_decode(text, text.index(f'"{name}":[') + len(name) + 3)[0]
                          for name in ("rows", "ways")))

    def check_page(self, rows, ways):
        self.assertEqual({r["number"]: r["gaps"] and [g[0] for g in r["gaps"]] for r in rows},
                         {row: gaps for row, (_, gaps) in self.rows.items()})
        self.assertEqual({r["number"]: len(r["line"]) // 2 for r in rows},  # a line joins trees
                         {row: n for row, (n, _) in self.rows.items()})
        told = sorted((w[0], w[3]) for w in self.ways)
        self.assertEqual(len(ways), len(told))
        for (kind, width_m), way in zip(told, sorted((w["kind"], w["width"]) for w in ways)):
            self.assertEqual(way[0], kind)
            self.assertLess(abs(way[1] - width_m), 6e-3, way)  # the page rounds to centimetres

    def test_the_live_page_at_the_end(self):
        done = subprocess.run(["bash", HERE + "/../in_namespace.sh", sys.executable, "-B", HERE + "/live_end.py",
                               BUILD, SOURCE + "/config/pullally.yaml", self.map + "/derived.lcm"],
                              stdout=subprocess.PIPE, text=True)
        if done.returncode == 77:
            self.skipTest("no network namespaces")
        self.assertEqual(done.returncode, 0)
        page = json.loads(done.stdout)
        self.assertEqual({int(i): tuple(number) for i, number in page["numbers"].items()}, self.numbers)
        self.check_page(page["rows"], page["ways"])

    def test_postgis(self):
        try:
            postgres.programs()
        except SystemExit:
            self.skipTest("no PostgreSQL with PostGIS")
        with postgres.Server() as server:
            run("publish", self.map, "--to", server.url(), "--block", "north", "--date", "2026-04-10")
            lines = server.sql('SELECT id, "row", "position" FROM orchard.tree')
        table = ([whole(number) for number in line.split("|")] for line in lines)
        self.assertEqual({i: (row, position) for i, row, position in table}, self.numbers)

    def test_report(self):
        run("report", self.map, "--out", self.folder + "/report")
        rows = {int(r["row"]): (int(r["trees"]), r["empty_positions"].split())
                for r in table(self.folder + "/report/report.csv") if r["row"] not in ("all", "other_trunks")}
        self.assertEqual(rows, {row: (n, [str(g) for g in gaps])
                                for row, (n, gaps) in self.rows.items()})

    def test_end_of_map_and_ways_on_the_bus(self):
        sys.path.insert(0, BUILD + "/lcmtypes/python")
        from orchard import map_tile_t, map_ways_t
        numbers, ways = {}, []
        for channel, data in events(self.map + "/derived.lcm"):
            if channel == "MAP":
                tile = map_tile_t.decode(data)
                for l in tile.landmarks:
                    numbers[l.id] = (l.row, l.position)
                for removed in tile.removed_ids:
                    numbers.pop(removed, None)
            if channel == "MAP_WAYS":
                ways += [("headland" if w.kind else "aisle", w.row_left, w.row_right,
                          *self.size_of({"width_m": w.width_m, "length_m": w.length_m}))
                         for w in map_ways_t.decode(data).ways]
        self.assertEqual(numbers, self.numbers)
        self.check_ways(ways)

    def test_an_unedited_export_is_no_correction(self):
        told = run("import-edits", self.map, self.export(), "--who", "test")
        self.assertEqual(told.strip(), "0 corrections")

    def test_a_deletion_changes_one_row(self):
        edited = self.folder + "/edited"
        shutil.copytree(self.map, edited)
        gone = next(i for i, (row, position) in self.numbers.items() if row == 2 and position == 4)
        run("edit", "delete", edited, str(gone))
        paths = [self.export()]
        paths.append(self.folder + "/after.gpkg")
        run("export", edited, "--format", "gpkg", "--out", paths[1], "--overwrite")
        before, after = ({f["row"]: f for f in layer(path, "rows")} for path in paths)
        self.assertEqual([row for row in before if before[row] != after[row]], ["2"])
        self.assertEqual(int(after["2"]["gaps"]), int(before["2"]["gaps"]) + 1)
        for name in ("aisles", "headlands", "nodes"):
            self.assertEqual(layer(paths[0], name), layer(paths[1], name), name)


if __name__ == "__main__":
    if not os.path.isdir(PULLALLY + "/map"):
        print("no map in", PULLALLY)
        sys.exit(77)
    if shutil.which("ogr2ogr") is None:
        print("no ogr2ogr; install gdal-bin")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)

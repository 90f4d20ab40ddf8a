#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""import_edits_test.py BIN: a map's GeoPackage is edited as QGIS edits it, by SQLite, and comes back as
corrections: the corrected map is what was drawn, with and without a place on the earth."""

import csv
import json
import math
import os
import random
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import maps  # noqa: E402

ORCHARD = sys.argv[1] + "/orchard"
LATITUDE, LONGITUDE = -27.6, 153.0  # the middle of its UTM zone: there metres are metres but for a scale of 0.9996
YAW = 0.3


def xy_of(blob):
    """The point in a GeoPackage's geometry: a header, perhaps an envelope, then WKB."""
    envelope = (blob[3] >> 1) & 7
    at = 8 + {0: 0, 1: 32, 2: 48, 3: 48, 4: 64}[envelope]
    return at, struct.unpack_from("<dd", blob, at + 5)


def moved(blob, dx, dy):
    at, (x, y) = xy_of(blob)
    blob = bytearray(blob)
    struct.pack_into("<dd", blob, at + 5, x + dx, y + dy)
    if (blob[3] >> 1) & 7 == 1:
        struct.pack_into("<dddd", blob, 8, x + dx, x + dx, y + dy, y + dy)
    return bytes(blob)


def opened(path):
    """With the functions that a GeoPackage's own triggers call."""
    database = sqlite3.connect(path)
    database.create_function("ST_IsEmpty", 1, lambda blob: 0)
    for name, k in (("ST_MinX", 0), ("ST_MaxX", 0), ("ST_MinY", 1), ("ST_MaxY", 1)):
        database.create_function(name, 1, lambda blob, k=k: xy_of(blob)[1][k])
    return database


class ImportEdits(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="orchard_import_edits_")
        self.map = self.folder + "/map"

    def tearDown(self):
        shutil.rmtree(self.folder)

    def write_map(self, georeferenced):
        maps.write_map(self.map, [maps.landmark(100 * row + k, 3.0 * k, 5.0 * row, row, k) for row in range(1, 5) for k in range(1, 11)],
                       [(1.5 * k, 7.5, 0.0) for k in range(20)], maps.datum(LATITUDE, LONGITUDE, yaw_rad=YAW) if georeferenced else None)

    def orchard(self, *words, code=0):
        result = subprocess.run([ORCHARD, *words], capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, code, result.stderr + result.stdout)
        return result

    def exported(self, name="block.gpkg"):
        path = f"{self.folder}/{name}"
        self.orchard("export", self.map, "--format", "gpkg", "--out", path, "--overwrite")
        return path

    def corrected(self):
        self.orchard("edit", "apply", self.map, "--out", self.folder + "/after")
        with open(self.folder + "/after/map.csv", encoding="ascii") as file:
            return {int(row["id"]): row for row in csv.DictReader(file)}

    def come_back(self, path, *words, code=0):
        return json.loads(self.orchard("import-edits", self.map, path, "--who", "Ana", "--json", *words, code=code).stdout)

    def check_all_kinds(self, georeferenced):
        self.write_map(georeferenced)
        # What was corrected before is no edit.
        self.orchard("edit", "delete", self.map, "110")
        self.orchard("edit", "note", self.map, "101", "old")
        path = self.exported()
        self.assertEqual(self.come_back(path)["added"], 0)

        # In the map's frame two metres along x: turned on the earth by its yaw, and by UTM's scale.
        scale = 0.9996 if georeferenced else 1.0
        yaw = YAW if georeferenced else 0.0
        step = 2.0 * scale * math.cos(yaw), 2.0 * scale * math.sin(yaw)
        with opened(path) as database:
            run = database.execute
            run("DELETE FROM landmarks WHERE id = 102")
            (blob,) = run("SELECT geom FROM landmarks WHERE id = 103").fetchone()
            run("UPDATE landmarks SET geom = ? WHERE id = 103", (moved(blob, *step),))
            run("UPDATE landmarks SET class = 'object' WHERE id = 204")
            run("UPDATE landmarks SET note = 'old; grafted' WHERE id = 101")
            run("UPDATE landmarks SET note = ? WHERE id = 205", ("<script>x</script>\n\né ",))
            # Two numbers change places.
            run("UPDATE landmarks SET position = 2 WHERE id = 301")
            run("UPDATE landmarks SET position = 1 WHERE id = 302")
            run("UPDATE rows SET label = 'by the road' WHERE row = 4")
            (end,) = run("SELECT geom FROM landmarks WHERE id = 410").fetchone()
            run("INSERT INTO landmarks (geom, class) VALUES (?, 'tree')", (moved(end, *step),))
        database.close()
        told = self.come_back(path)
        self.assertEqual(told["conflicts"], [])
        self.assertEqual(told["left_out"], ["line breaks in the note of landmark 205"])
        # Two that change places: both numbers are given back, then given.
        self.assertEqual(told["counts"], {"delete": 1, "move": 1, "class": 1, "note": 2, "renumber": 4, "row": 1, "add": 1})
        after = self.corrected()
        self.assertEqual(len(after), 40 - 2 + 1)
        self.assertNotIn(102, after)
        self.assertAlmostEqual(float(after[103]["x_m"]), 11.0, delta=0.005)
        self.assertAlmostEqual(float(after[103]["y_m"]), 5.0, delta=0.005)
        self.assertEqual(after[204]["class"], "object")
        self.assertEqual((after[301]["position"], after[302]["position"]), ("2", "1"))
        new = after[max(after)]
        self.assertAlmostEqual(float(new["x_m"]), 32.0, delta=0.005)
        self.assertAlmostEqual(float(new["y_m"]), 20.0, delta=0.005)
        with open(self.map + "/corrections.jsonl", encoding="utf-8") as file:
            lines = [json.loads(line) for line in file]
        self.assertEqual([line.get("note") for line in lines if line["what"] == "note"],
                         ["old", "grafted", "<script>x</script> é"])
        self.assertEqual([line["name"] for line in lines if line["what"] == "row"], ["by the road"])
        # The same file again changes nothing: all is so already. Notes are said twice, or not at all.
        again = self.come_back(path)
        self.assertEqual(set(again["counts"]) - {"note", "renumber", "class", "move", "row"}, set(), again)

    def test_all_kinds_in_the_maps_own_metres(self):
        self.check_all_kinds(georeferenced=False)

    def test_all_kinds_on_the_earth(self):
        self.check_all_kinds(georeferenced=True)

    def test_what_others_said_since_is_a_conflict(self):
        self.write_map(georeferenced=False)
        path = self.exported()
        self.orchard("edit", "delete", self.map, "105")
        self.orchard("edit", "renumber", self.map, "106", "--row", "9", "--position", "9")
        with opened(path) as database:
            database.execute("UPDATE landmarks SET class = 'object' WHERE id = 105")
            database.execute("UPDATE landmarks SET row = 9, position = 9 WHERE id = 107")
            database.execute("UPDATE landmarks SET class = 'object' WHERE id = 208")
        database.close()
        told = self.come_back(path, "--dry-run", code=3)
        self.assertEqual((told["added"], len(told["conflicts"])), (1, 2), told)
        told = self.come_back(path, code=3)
        self.assertEqual((told["added"], len(told["conflicts"])), (1, 2), told)
        after = self.corrected()
        self.assertNotIn(105, after)
        self.assertEqual(after[208]["class"], "object")

    def test_a_part_of_the_map_deletes_nothing_unasked(self):
        self.write_map(georeferenced=False)
        path = self.exported()
        with opened(path) as database:
            database.execute("DELETE FROM landmarks WHERE row > 1")
            database.execute("UPDATE landmarks SET class = 'object' WHERE id = 101")
        database.close()
        self.assertIn("--keep-missing", self.orchard("import-edits", self.map, path, code=3).stderr)
        self.assertFalse(os.path.exists(self.map + "/corrections.jsonl"))
        self.assertEqual(self.come_back(path, "--keep-missing")["counts"], {"class": 1})

    def test_random_edits_come_back_as_they_were_drawn(self):
        """The truth is what was drawn: a table of our own."""
        self.write_map(georeferenced=True)
        path = self.exported()
        chance = random.Random(5)
        truth = {100 * row + k: [3.0 * k, 5.0 * row, "tree"] for row in range(1, 5) for k in range(1, 11)}
        with opened(path) as database:
            for number in chance.sample(sorted(truth), 25):
                kind = chance.choice(("delete", "move", "class"))
                if kind == "delete":
                    database.execute("DELETE FROM landmarks WHERE id = ?", (number,))
                    del truth[number]
                elif kind == "move":
                    dx, dy = chance.uniform(-0.8, 0.8), chance.uniform(-0.8, 0.8)
                    (blob,) = database.execute("SELECT geom FROM landmarks WHERE id = ?", (number,)).fetchone()
                    turned = [0.9996 * (dx * math.cos(YAW) - dy * math.sin(YAW)),
                              0.9996 * (dx * math.sin(YAW) + dy * math.cos(YAW))]
                    database.execute("UPDATE landmarks SET geom = ? WHERE id = ?", (moved(blob, *turned), number))
                    truth[number][0] += dx
                    truth[number][1] += dy
                else:
                    database.execute("UPDATE landmarks SET class = 'object' WHERE id = ?", (number,))
                    truth[number][2] = "object"
        database.close()
        told = self.come_back(path)
        self.assertEqual((told["added"], told["conflicts"]), (25, []))
        after = self.corrected()
        self.assertEqual(set(after), set(truth))
        for number, (x, y, kind) in truth.items():
            self.assertEqual(after[number]["class"], kind)
            self.assertLess(math.hypot(float(after[number]["x_m"]) - x, float(after[number]["y_m"]) - y), 0.005)

    def test_what_is_no_map_is_refused(self):
        self.write_map(georeferenced=False)
        for name, content in (("a.gpkg", b""), ("b.gpkg", b"SQLite format 3\0" + b"x" * 2000)):
            with open(f"{self.folder}/{name}", "wb") as file:
                file.write(content)
            self.orchard("import-edits", self.map, f"{self.folder}/{name}", code=3)
        self.orchard("import-edits", self.map, self.folder + "/none.gpkg", code=3)
        path = self.exported()
        with opened(path) as database:
            database.execute("UPDATE landmarks SET class = 'shrub' WHERE id = 101")
        database.close()
        self.assertIn("shrub", self.orchard("import-edits", self.map, path, code=3).stderr)


unittest.main(argv=sys.argv[:1])

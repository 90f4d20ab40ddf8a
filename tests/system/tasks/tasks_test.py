# SPDX-License-Identifier: BSD-3-Clause
"""orchard tasks: what gaps and changes call for, ticked by hand and by GDAL as QGIS does it, and brought up to date
after the next drive. Usage: tasks_test.py BIN."""
import json
import os
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import maps  # noqa: E402

ORCHARD = sys.argv[1] + "/orchard"
NUM_ROWS, NUM_TREES, ROW_M, TREE_M = 6, 12, 5.0, 3.0
SPRING_GAPS, GONE = {(2, 4), (3, 7), (5, 5)}, (4, 6)
SPRING_US, AUTUMN_US = 1777888800000000, 1792317600000000  # 2026-05-04 and 2026-10-18, 10:00 UTC


def place(row, tree):
    """Planted to some centimetres, so that each block of trees is itself alone."""
    return TREE_M * tree + 0.07 * ((7 * row + 3 * tree) % 5 - 2), ROW_M * row + 0.05 * ((5 * row + 11 * tree) % 7 - 3)


def write_map(folder, gaps, first_utime, georeference=True):
    trees = [(row, tree) for row in range(1, NUM_ROWS + 1) for tree in range(1, NUM_TREES + 1) if (row, tree) not in gaps]
    lines = [maps.landmark(100 * row + tree, *place(row, tree), row, tree) for row, tree in trees]
    path = [(step if row % 2 == 0 else 40 - step, ROW_M * (row + 0.5), 3.14159 * (row % 2))
            for row in range(NUM_ROWS + 1) for step in range(0, 41)]
    maps.write_map(folder, lines, path, maps.datum(-27.6, 151.9) if georeference else None, first_utime=first_utime,
                   last_utime_us=first_utime, first_utime_us=first_utime)


class Tasks(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="orchard_tasks_")
        self.addCleanup(temporary.cleanup)
        self.folder = temporary.name
        self.spring, self.autumn = self.folder + "/spring", self.folder + "/autumn"
        write_map(self.spring, SPRING_GAPS, SPRING_US)
        write_map(self.autumn, SPRING_GAPS - {(3, 7)} | {GONE}, AUTUMN_US)  # one was planted, one has gone

    def run_tasks(self, map_folder, out, *words):
        return subprocess.run([ORCHARD, "tasks", map_folder, "--out", f"{self.folder}/{out}", *words], capture_output=True,
                              text=True)

    def tasks(self, map_folder, out, *words):
        done = self.run_tasks(map_folder, out, *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.said = done.stdout + done.stderr
        return self.read(out)

    def read(self, out):
        """The tasks by place, as GDAL reads them; where several have one, the last."""
        text = subprocess.run(["ogr2ogr", "-f", "GeoJSON", "/vsistdout/", f"{self.folder}/{out}", "tasks", "-t_srs",
                               "EPSG:4326"],
                              check=True, capture_output=True, text=True).stdout
        features = json.loads(text)["features"]
        return {(int(f["properties"]["row"]), f["properties"]["tree"]): f["properties"] for f in features}

    def tick(self, out, where):
        """As an editor of attributes does it."""
        with open(f"{self.folder}/{out}", encoding="utf-8") as file:
            content = json.load(file)
        for feature in content["features"]:
            if (int(feature["properties"]["row"]), feature["properties"]["tree"]) == where:
                feature["properties"].update(state="Done", note="Gala, 2 años")
        with open(f"{self.folder}/{out}", "w", encoding="utf-8") as file:
            json.dump(content, file)

    def states(self, tasks):
        return {where: task["state"] for where, task in tasks.items()}

    def test_a_season(self):
        tasks = self.tasks(self.spring, "tasks.geojson")
        self.assertEqual(self.states(tasks), dict.fromkeys(SPRING_GAPS, "open"))
        for task in tasks.values():
            self.assertEqual((task["what"], task["why"], task["since"]), ("plant", "gap", "2026-05-04"))
        self.tick("tasks.geojson", (2, 4))
        tasks = self.tasks(self.autumn, "tasks.geojson", "--ticked", self.folder + "/tasks.geojson", "--overwrite")
        self.assertEqual(self.states(tasks), {(2, 4): "done", (5, 5): "open", (3, 7): "done", GONE: "open"})
        self.assertEqual((tasks[2, 4]["note"], tasks[2, 4].get("seen")), ("Gala, 2 años", None))
        self.assertEqual((tasks[3, 7]["seen"], tasks[GONE]["since"]), ("2026-10-18", "2026-10-18"))
        self.assertIn("2 open, 2 done; 1 new, 1 done as a tree stands there now", self.said)
        before = tasks
        self.assertEqual(self.tasks(self.autumn, "same.geojson", "--ticked", self.folder + "/tasks.geojson"), before)

    def test_what_changed_between_two_seasons(self):
        tasks = self.tasks(self.autumn, "tasks.gpkg", "--previous", self.spring)
        self.assertEqual(set(tasks), {(2, 4), (5, 5), GONE})
        self.assertEqual(tasks[GONE]["why"], "missing since 2026-05-04")
        self.assertEqual(tasks[5, 5]["why"], "gap")

    def test_a_geopackage_ticked_as_by_sql(self):
        self.tasks(self.spring, "tasks.gpkg")
        subprocess.run(["ogrinfo", "-q", self.folder + "/tasks.gpkg", "-sql",
                        "UPDATE tasks SET state = 'done' WHERE tree = 5"], check=True, stdout=subprocess.DEVNULL)
        tasks = self.tasks(self.autumn, "later.gpkg", "--ticked", self.folder + "/tasks.gpkg")
        self.assertEqual(self.states(tasks), {(2, 4): "open", (5, 5): "done", (3, 7): "done", GONE: "open"})

    def test_a_map_without_a_datum(self):
        write_map(self.spring, SPRING_GAPS, SPRING_US, georeference=False)
        refused = self.run_tasks(self.spring, "tasks.geojson")
        self.assertEqual(refused.returncode, 3)
        self.assertIn("not georeferenced", refused.stderr)
        done = self.run_tasks(self.spring, "tasks.gpkg")
        self.assertEqual(done.returncode, 0, done.stderr)
        done = self.run_tasks(self.spring, "again.gpkg", "--ticked", self.folder + "/tasks.gpkg", "--json")
        self.assertEqual({k: v for k, v in json.loads(done.stdout).items() if k != "file"},
                         {"open": 3, "done": 0, "new": 0, "seen": 0})

    def test_for_a_receiver(self):
        self.tasks(self.spring, "tasks.geojson")
        self.tick("tasks.geojson", (2, 4))
        done = self.run_tasks(self.spring, "tasks.gpx", "--ticked", self.folder + "/tasks.geojson")
        self.assertEqual(done.returncode, 0, done.stderr)
        root = xml.etree.ElementTree.parse(self.folder + "/tasks.gpx").getroot()
        names = sorted(e.text for e in root.iter("{http://www.topografix.com/GPX/1/1}name"))
        self.assertEqual(names, ["plant 2/4 (done)", "plant 3/7", "plant 5/5"])
        states = sorted(e.text for e in root.iter("{http://osgeo.org/gdal}state"))
        self.assertEqual(states, ["done", "open", "open"])

    def test_what_cannot_be_taken_is_named(self):
        self.tasks(self.spring, "tasks.geojson")
        with open(self.folder + "/tasks.geojson", encoding="utf-8") as file:
            whole = json.load(file)

        def says(words, change):
            content = json.loads(json.dumps(whole))
            change(content["features"])
            with open(self.folder + "/bad.geojson", "w", encoding="utf-8") as file:
                json.dump(content, file)
            done = self.run_tasks(self.spring, "out.geojson", "--ticked", self.folder + "/bad.geojson", "--overwrite")
            self.assertEqual(done.returncode, 3, words)
            self.assertIn(words, done.stderr)

        says('state "perhaps" must be open or done', lambda all: all[1]["properties"].update(state="perhaps"))
        says("is there twice", lambda all: all.append(all[0]))
        says("is not a point", lambda all: all[0].update(geometry={"type": "LineString", "coordinates": [[151, -27], [152, -27]]}))
        says("km from the map", lambda all: all[0]["geometry"].update(coordinates=[5, 50]))
        says("must be a whole number", lambda all: all[0]["properties"].update(task=-3))
        says("no column what", lambda all: [f["properties"].pop("what") for f in all])
        says("is too long", lambda all: all[0]["properties"].update(note="x" * 5000))
        self.assertIn("exists already", self.run_tasks(self.spring, "tasks.geojson").stderr)
        self.assertIn("change --out", self.run_tasks(self.spring, "tasks.kml").stderr)

    def test_points_of_ones_own_and_another_block(self):
        self.tasks(self.spring, "tasks.geojson")
        with open(self.folder + "/tasks.geojson", encoding="utf-8") as file:
            content = json.load(file)
        content["features"] = [{"type": "Feature", "geometry": content["features"][0]["geometry"],
                                "properties": {"task": None, "state": None, "what": "mend the drip line", "row": "2", "tree": 4}}]
        with open(self.folder + "/own.geojson", "w", encoding="utf-8") as file:
            json.dump(content, file)
        self.tasks(self.spring, "both.geojson", "--ticked", self.folder + "/own.geojson")
        with open(self.folder + "/both.geojson", encoding="utf-8") as file:
            own = [f["properties"] for f in json.load(file)["features"] if f["properties"]["what"] == "mend the drip line"]
        self.assertEqual([(task["task"], task["state"]) for task in own], [(1, "open")])
        self.assertIn("is it of another block", self.said)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

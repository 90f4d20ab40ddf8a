# SPDX-License-Identifier: BSD-3-Clause
"""orchard plan on the maps of a real orchard, which hold more bushes and pieces of a hedge than trees: a plan of the
trees in rows but one, in a national coordinate system and with names of letters, gives each tree its name back, and the
page, the report and the exports say it.
Usage: plan_test.py BUILD SOURCE PULLALLY..., the folders that hold map/."""
import csv
import json
import math
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import unittest

BUILD, SOURCE = sys.argv[1:3]
FOLDERS = sys.argv[3:]
sys.path.insert(0, SOURCE + "/tests/system/view")
import browser  # noqa: E402

SYSTEM = "EPSG:5361"  # SIRGAS-Chile, zone 19 south
NAMES = ["A-Sur", "A2-Sur", "A10-Sur", "B-Norte", "B-Sur", "C-Norte", "C-Sur", "D-Norte"]  # in their order


def run(*arguments):
    done = subprocess.run([BUILD + "/bin/orchard", *arguments], check=False, text=True, capture_output=True)
    assert done.returncode == 0, (arguments, done.stderr)
    return done.stdout


def table(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class Plan(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="orchard_plan_")
        self.addCleanup(shutil.rmtree, self.folder)

    def plan_of(self, map_folder):
        """A GeoPackage of the map's trees in rows but one; the names by id, and the id of that one."""
        run("export", map_folder, "--format", "geojson", "--layer", "landmarks", "--out", self.folder + "/map.geojson",
            "--overwrite")
        with open(self.folder + "/map.geojson", encoding="utf-8") as file:
            features = json.load(file)["features"]
        in_rows = [f for f in features if f["properties"]["class"] == "tree" and f["properties"].get("row")]
        self.assertGreater(len(features), len(in_rows) * 3 // 2, "a map with bushes is wanted")
        left_out = in_rows.pop(len(in_rows) // 2)["properties"]["id"]
        names, planned = {}, []
        for feature in reversed(in_rows):  # the file's order is not that of the names
            tree = feature["properties"]
            names[tree["id"]] = (NAMES[tree["row"] - 1], str(tree["position"]))
            planned.append({"type": "Feature", "geometry": feature["geometry"],
                            "properties": dict(zip(("fila", "arbol"), names[tree["id"]]))})
        with open(self.folder + "/plan.geojson", "w", encoding="utf-8") as file:
            json.dump({"type": "FeatureCollection", "features": planned}, file)
        path = self.folder + "/plan.gpkg"
        subprocess.run(["ogr2ogr", "-f", "GPKG", path, self.folder + "/plan.geojson", "-t_srs", SYSTEM], check=True)
        return path, names, left_out

    def test_names_all_trees_of_a_real_orchard(self):
        for folder in FOLDERS:
            with self.subTest(folder):
                path, names, left_out = self.plan_of(folder + "/map")
                named = self.folder + "/" + os.path.basename(folder)
                run("plan", path, "--map", folder + "/map", "--out", named)
                given = {int(row["id"]): (row["row"], row["tree"]) for row in table(named + "/names.csv") if row["tree"]}
                self.assertEqual(given, names)
                extra = {int(row["id"]): row["row"] for row in table(named + "/plan.csv") if row["deviation"] == "extra"}
                self.assertNotEqual(extra[left_out], "", "the tree that is not in the plan stands in a row of it")
                self.check_outputs(named, names)
                run("report", folder + "/map", "--out", self.folder + "/report")
                with open(self.folder + "/report/report.html", encoding="utf-8") as file:
                    self.assertIn("made without a camera", file.read())

    def test_no_empty_place_is_beside_a_trunk(self):
        for folder in FOLDERS:
            trunks = [row for row in table(folder + "/map/map.csv") if row["class"] == "tree"]
            at = {row["id"]: complex(float(row["x_m"]), float(row["y_m"])) for row in trunks}
            rows = {}
            for row in trunks:
                if row["position"]:
                    rows.setdefault(row["row"], []).append((int(row["position"]), row["id"]))
            for row, trees in rows.items():
                trees.sort()
                steps = [(at[b] - at[a]) / (l - k) for (k, a), (l, b) in zip(trees, trees[1:])]
                spacing_m = statistics.median(map(abs, steps))
                for (k, a), (l, _), step in zip(trees, trees[1:], steps):
                    for place in range(k + 1, l):
                        nearest_m = min(abs(at[a] + (place - k) * step - p) for p in at.values())
                        self.assertGreater(nearest_m, spacing_m / 4, f"{folder}: row {row} place {place}")

    def check_outputs(self, named, names):
        landmarks = table(named + "/map.csv")
        trees = [row for row in landmarks if row["class"] == "tree" and row["row"]]
        num_others = sum(row["class"] == "tree" for row in landmarks) - len(trees)
        self.assertGreater(num_others, 10)
        row_names = [name for name in NAMES if name in {row for row, _ in names.values()}]
        run("report", named)
        self.assertEqual([row["row"] for row in table(named + "/report/report.csv")][:len(row_names)], row_names)
        with open(named + "/report/report.html", encoding="utf-8") as file:
            text = file.read()
        self.assertIn(f"Trees in rows: {len(trees)}; rows: {len(row_names)}.", text)
        self.assertIn(f"Other trunks, in no row: {num_others},", text)
        area_cm2 = sum(math.pi / 4 * (100 * float(tree["width_m"])) ** 2 for tree in trees)
        self.assertIn(f"Trunk cross-sectional area: {area_cm2:.0f} cm² in all", text)
        self.assertNotIn("view of the camera", text)
        for name in row_names:
            self.assertIn(f">{name}</td>", text)
        out = self.folder + "/out.geojson"
        run("export", named, "--format", "geojson", "--layer", "landmarks", "--out", out, "--overwrite")
        with open(out, encoding="utf-8") as file:
            labels = {f["properties"]["id"]: f["properties"]["label"] for f in json.load(file)["features"]}
        for number, (row, tree) in names.items():
            self.assertEqual(labels[number], f"{row}/{tree}")
        if shutil.which("chromedriver") and shutil.which("chromium"):
            self.check_search(named, names)

    def check_search(self, named, names):
        number, (row, tree) = max(names.items())
        landmarks = table(named + "/map.csv")
        num_trees = sum(1 for l in landmarks if l["class"] == "tree" and l["row"])
        with browser.Browser() as page:
            page.open(f"file://{named}/map.html")
            summary = page.run("return document.getElementById('summary').textContent").replace("\u00a0", " ")
            self.assertIn(f"{num_trees} trees in rows", summary)
            self.assertIn("other trunks", summary)
            for query in (f"{row} {tree}", f"{row.lower()}/{tree}", f"row {row} tree {tree}"):
                page.run("orchardApp.select(-1)")
                page.type_into("#query", query + "\n")
                self.assertEqual(page.run("return orchardApp.selectedId"), number, query)
            title = page.run("return document.querySelector('#details h2').textContent")
            self.assertEqual(title, f"Row {row}, tree {tree}")
            rows = page.run("return [...document.querySelectorAll('#rows td:first-child')].map((cell) => cell.textContent)")
            self.assertEqual(rows, [f"Row {name}" for name in NAMES if name in {r for r, _ in names.values()}])


if __name__ == "__main__":
    if not all(os.path.isdir(folder + "/map") for folder in FOLDERS) or shutil.which("ogr2ogr") is None:
        print("no recordings, or no ogr2ogr; install gdal-bin")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])

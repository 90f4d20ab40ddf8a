# SPDX-License-Identifier: BSD-3-Clause
"""orchard export: each format is read back by GDAL's ogr2ogr; places come from the ellipsoid's
radii, not from the code under test. Usage: export_test.py BIN."""
import csv
import io
import json
import math
import os
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import jsonschema
import numpy
import yaml

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import maps  # noqa: E402

ORCHARD = sys.argv[1] + "/orchard"
# What nav2_route reads of a graph.
NUMBER, PLACE = {"type": "integer", "minimum": 0}, {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}
ROUTE_GRAPH = {"type": "array", "minItems": 3, "items": {"oneOf": [
    {"properties": {"type": {"const": "Feature"},
                    "properties": {"required": ["id", "frame"], "properties": {"id": NUMBER, "frame": {"const": "map"}}},
                    "geometry": {"properties": {"type": {"const": "Point"}, "coordinates": PLACE}}},
     "required": ["type", "properties", "geometry"]},
    {"properties": {"type": {"const": "Feature"},
                    "properties": {"required": ["id", "startid", "endid"],
                                   "properties": {"id": NUMBER, "startid": NUMBER, "endid": NUMBER,
                                                  "cost": {"type": "number"}, "metadata": {"type": "object"}}},
                    "geometry": {"properties": {"type": {"const": "LineString"},
                                                "coordinates": {"type": "array", "items": PLACE}}}},
     "required": ["type", "properties", "geometry"]}]}}
TEXT = {"type": "string"}
TOPOLOGICAL_MAP = {
    "type": "object", "required": ["meta", "metric_map", "name", "nodes", "pointset"],
    "properties": {
        "meta": {"required": ["last_updated"], "properties": {"last_updated": {
            "type": "string", "pattern": "^[0-9]{4}-[0-9]{2}-[0-9]{2}_[0-9]{2}-[0-9]{2}-[0-9]{2}$"}}},
        "metric_map": TEXT, "name": TEXT, "pointset": TEXT,
        "nodes": {"type": "array", "items": {"required": ["meta", "node"], "properties": {
            "meta": {"required": ["map", "node", "pointset"]},
            "node": {"required": ["edges", "name", "parent_frame"], "properties": {
                "name": TEXT, "parent_frame": TEXT, "edges": {"type": "array", "items": {
                    "required": ["edge_id", "node"], "properties": {"edge_id": TEXT, "node": TEXT}}}}}}}}}}
LATITUDE, LONGITUDE = -27.6, 151.9
UTM = "EPSG:32756"
NAMES = {"geojson": "a.geojson", "kml": "a.kml", "shp": "a.shp.zip", "dxf": "a.dxf",
         "csv": "a.csv", "flatgeobuf": "a.fgb", "gpkg": "a.gpkg"}
COLUMNS_OF_TEN = {"probability": "probabilit", "diameter_mm": "diameter_m"}
# Rows of 6 places 3 m apart, 5 m from row to row; in row 2 place 4 is empty; then an object.
TREES = {100 * row + k: (3.0 * k, 5.0 * row) for row in (1, 2) for k in range(1, 7)
         if (row, k) != (2, 4)}
THINGS = {**TREES, 900: (30.0, -4.0)}
DELETED, NOTED, NOTE = 103, 201, "injertado en agosto, año 2"


def degrees(x_m, y_m):
    """WGS 84: what metres east and north of the datum are in degrees, for some tens of metres."""
    a, e2 = 6378137.0, 0.00669437999014
    s = math.sin(math.radians(LATITUDE))
    across = a / math.sqrt(1 - e2 * s * s)
    along = a * (1 - e2) / (1 - e2 * s * s) ** 1.5
    return (LONGITUDE + math.degrees(x_m / (across * math.cos(math.radians(LATITUDE)))),
            LATITUDE + math.degrees(y_m / along))


class Export(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="orchard_export_")
        self.map = self.folder + "/map"
        self.write_map(georeferenced=True)

    def tearDown(self):
        shutil.rmtree(self.folder)

    def write_map(self, georeferenced):
        lines = []
        for number, (x, y) in THINGS.items():
            row, k = ("", "") if number == 900 else divmod(number, 100)
            lines.append(maps.landmark(number, x, y, row, k, kind="object" if number == 900 else "tree"))
        maps.write_map(self.map, lines, [(k, 7.5, 0.0) for k in range(20)],
                       maps.datum(LATITUDE, LONGITUDE) if georeferenced else None)

    def edit(self, *words):
        done = subprocess.run([ORCHARD, "edit", words[0], self.map, *words[1:]], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def run_export(self, word, *more, out=None):
        self.out = f"{self.folder}/out/{out or NAMES[word]}"
        return subprocess.run([ORCHARD, "export", self.map, "--format", word, "--out", self.out,
                               *more], capture_output=True, text=True)

    def export(self, word, *more, **named):
        done = self.run_export(word, *more, **named)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def read(self, layer, *more):
        """Rows of a layer of what was exported last, with columns X and Y."""
        done = subprocess.run(["ogr2ogr", "-f", "CSV", "/vsistdout/", self.out, *layer, "-lco",
                               "GEOMETRY=AS_XY", *more], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return list(csv.DictReader(io.StringIO(done.stdout)))

    def check_things(self, rows, expected, place_of, tolerance, message):
        self.assertEqual(len(rows), len(expected), message)
        for number, place in expected.items():
            wanted = place_of(*place)
            near = [r for r in rows if abs(float(r["X"]) - wanted[0]) < tolerance and
                    abs(float(r["Y"]) - wanted[1]) < tolerance]
            self.assertEqual(len(near), 1, f"{message}: {number} at {wanted}")
            if "id" in near[0]:
                self.assertEqual(int(float(near[0]["id"])), number, message)
                self.assertEqual(near[0]["class"], "object" if number == 900 else "tree", message)
                self.assertAlmostEqual(float(near[0]["width_m"]), 0.12, 6, message)

    def test_the_bits_of_a_coordinate_do_not_depend_on_the_processor(self):
        self.export("gpkg")
        with sqlite3.connect(self.out) as file:
            points = [blob for (blob,) in file.execute("SELECT geom FROM landmarks")]
            places = file.execute("SELECT latitude_deg, longitude_deg FROM landmarks").fetchall()
        metres = [v for blob in points for v in struct.unpack("<2d", blob[-16:])]
        self.assertEqual(len(metres), 2 * len(THINGS))
        for values, digits in ((metres, 4), (sum(places, ()), 9)):
            self.assertEqual(values, type(values)(round(value, digits) for value in values))
        files = {}
        for less in ("", "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F"):
            os.environ["GLIBC_TUNABLES"] = less
            self.addCleanup(os.environ.pop, "GLIBC_TUNABLES", None)
            for word in set(NAMES) - {"shp"}:  # a zip tells when it was written
                self.export(word, "--overwrite")
                with open(self.out, "rb") as file:
                    data = file.read()
                self.assertEqual(files.setdefault(word, data), data, word)

    def test_each_format_on_the_earth(self):
        self.edit("delete", str(DELETED))
        self.edit("note", str(NOTED), NOTE)
        expected = {k: p for k, p in THINGS.items() if k != DELETED}
        for word in NAMES:
            said = self.export(word)
            layer = {"dxf": ["entities", "-where", "Text IS NULL AND Layer IN ('tree', 'object')"],
                     "csv": []}.get(word, ["landmarks"])
            more = {"dxf": ["-s_srs", UTM], "csv": []}.get(word, [])
            if word == "csv":
                rows = [{**r, "X": r["longitude_deg"], "Y": r["latitude_deg"]}
                        for r in self.read(layer)]
            else:
                rows = self.read(layer, *more, "-t_srs", "EPSG:4326")
            self.check_things(rows, expected, degrees, 3e-8, word)
            self.assertIn("EPSG:4326" if word in ("geojson", "kml", "csv") else UTM, said)
            self.assertIn("corrections: 2 applied", said)
            if word == "dxf":
                labels = self.read(["entities", "-where", "Text IS NOT NULL"])
                self.assertIn("2/1", {r["Text"] for r in labels})
                continue
            noted = [r for r in rows if r.get("note")]
            self.assertEqual([(int(float(r["id"])), r["note"]) for r in noted], [(NOTED, NOTE)],
                             word)
            for column in ("probability", "diameter_mm"):
                column = COLUMNS_OF_TEN[column] if word == "shp" else column
                self.assertIn(column, rows[0], word)

    def test_lines_and_gaps_and_one_layer(self):
        for word in ("kml", "shp", "gpkg"):
            self.export(word)
            self.assertEqual(len(self.read(["rows"])), 2, word)
            self.assertEqual(len(self.read(["path"])), 1, word)
            gaps = self.read(["gaps"], "-t_srs", "EPSG:4326")
            self.assertEqual(len(gaps), 1, word)
            wanted = degrees(12.0, 10.0)
            self.assertAlmostEqual(float(gaps[0]["X"]), wanted[0], 6, word)
            self.assertAlmostEqual(float(gaps[0]["Y"]), wanted[1], 6, word)
        for word in ("geojson", "csv", "flatgeobuf"):
            self.assertIn("left out: extents, path, rows, gaps", self.export(word, "--overwrite"))
            said = json.loads(self.export(word, "--layer", "rows", "--json", "--overwrite"))
            self.assertEqual(said["layers"], {"rows": 2}, word)
            self.assertIn("landmarks", said["left_out"])
            self.assertEqual(len(self.read([])), 2, word)

    def test_a_shapefile_as_its_parts(self):
        said = self.export("shp", out="parts.shp")
        self.assertIn("left out: extents, path, rows, gaps", said)
        self.assertEqual(sorted(os.listdir(self.folder + "/out")),
                         ["parts.cpg", "parts.dbf", "parts.prj", "parts.shp", "parts.shx"])
        self.check_things(self.read([], "-t_srs", "EPSG:4326"), THINGS, degrees, 3e-8, "shp")
        os.remove(self.out)
        self.assertIn("parts.cpg exists already", self.run_export("shp", out="parts.shp").stderr)
        self.export("shp", "--layer", "rows", "--overwrite", out="parts.shp")
        self.assertEqual(len(self.read([])), 2)

    def test_kml_of_many_trees(self):
        """Twenty thousand end well before this test's limit, where each tree cost a copy of all before it: hours."""
        lines = [maps.landmark(k + 1, 3.0 * (k % 100), 5.0 * (k // 100), k // 100 + 1, k % 100 + 1) for k in range(20000)]
        maps.write_map(self.map, lines, (), maps.datum(LATITUDE, LONGITUDE))
        self.export("kml")
        with open(self.out, encoding="utf-8") as file:
            text = file.read()
        for what, num in (('<SimpleData name="id">', 20000), ("<name>200/100</name>", 1), ("<LineString>", 200 + 1)):  # rows, path
            self.assertEqual(text.count(what), num, what)

    def test_gpx_for_receivers(self):
        self.export("gpx", out="a.gpx")
        points = self.gpx("wpt")
        self.assertEqual(len(points), len(THINGS))
        for number, place in THINGS.items():
            longitude, latitude = degrees(*place)
            name = "#900" if number == 900 else f"{number // 100}/{number % 100}"
            at = [(float(p.get("lon")), float(p.get("lat"))) for p in points if self.name_of(p) == name]
            self.assertEqual(len(at), 1, name)
            self.assertAlmostEqual(at[0][0], longitude, 6)
            self.assertAlmostEqual(at[0][1], latitude, 6)
        self.export("gpx", "--layer", "gaps", "--overwrite", out="a.gpx")
        self.assertEqual([self.name_of(p) for p in self.gpx("wpt")], ["2/4"])
        self.export("gpx", "--layer", "path", "--overwrite", out="a.gpx")
        self.assertEqual(len(self.gpx("trkpt")), 20)
        self.assertEqual(len(self.read(["tracks"])), 1)  # by GDAL

    def gpx(self, tag):
        return list(xml.etree.ElementTree.parse(self.out).iter("{http://www.topografix.com/GPX/1/1}" + tag))

    def name_of(self, point):
        return point.findtext("{http://www.topografix.com/GPX/1/1}name")

    def write_graph(self):
        """An aisle that bends by half a metre in its middle, and a headland."""
        aisle = [[0, 7.5], [5, 7.5], [10, 8.0], [15, 7.5], [20, 7.5]]
        edges = [{"id": 1, "kind": "aisle", "from": 1, "to": 2, "row_left": 2, "row_right": 1,
                  "length_m": 20.1, "width_m": 3.0, "line": aisle},
                 {"id": 2, "kind": "headland", "from": 2, "to": 3, "row": 2, "length_m": 5.0,
                  "width_m": 2.0, "line": [[20, 7.5], [20, 12.5]]}]
        nodes = [{"id": 1, "place": [0, 7.5]}, {"id": 2, "place": [20, 7.5]},
                 {"id": 3, "place": [20, 12.5]}]
        with open(self.map + "/graph.json", "w") as file:
            json.dump({"frame": "map", "unit": "m", "nodes": nodes, "edges": edges}, file)
        return aisle

    def test_a_graph_for_nav2(self):
        """By the rules of nav2_route's GeoJSON loader, which drives straight from node to node."""
        self.assertIn("graph.json", self.run_export("nav2", out="a.geojson").stderr)
        aisle = self.write_graph()
        self.export("nav2", out="a.geojson")
        with open(self.out) as file:
            features = json.load(file)["features"]
        jsonschema.validate(features, ROUTE_GRAPH)
        ids = [f["properties"]["id"] for f in features]
        self.assertEqual(len(ids), len(set(ids)))
        places = {f["properties"]["id"]: f["geometry"]["coordinates"] for f in features
                  if f["geometry"]["type"] == "Point"}
        names = {f["properties"]["metadata"]["name"]: f["geometry"]["coordinates"] for f in features
                 if "name" in f["properties"].get("metadata", {})}
        self.assertEqual(names, {"R2_IN": aisle[0], "R2_OUT": aisle[-1]})
        ways = {}
        for feature in features:
            if feature["geometry"]["type"] == "LineString":
                p = feature["properties"]
                self.assertEqual(feature["geometry"]["coordinates"], [places[p["startid"]], places[p["endid"]]])
                ways.setdefault(p["startid"], []).append((p["endid"], p["cost"]))
        for start, ends in ways.items():  # every way leads back
            for end, cost in ends:
                self.assertIn((start, cost), ways[end])
        for bend in aisle:
            self.assertIn(bend, places.values())
        self.assertEqual(len(self.read(["-where", "startid IS NOT NULL"])), 2 * (len(aisle) - 1 + 1))  # by GDAL

    def test_a_topological_map(self):
        """By the schema of L-CAS's topological_navigation (tmap-schema.yaml, draft-07)."""
        aisle = self.write_graph()
        self.export("tmap2", out="a.yaml")
        with open(self.out) as file:
            topology = yaml.safe_load(file)
        jsonschema.validate(topology, TOPOLOGICAL_MAP)
        nodes = {each["node"]["name"]: each["node"] for each in topology["nodes"]}
        self.assertEqual(len(nodes), len(topology["nodes"]))
        places = {name: [node["pose"]["position"][axis] for axis in "xy"] for name, node in nodes.items()}
        self.assertEqual((places["R2_IN"], places["R2_OUT"]), (aisle[0], aisle[-1]))
        # From one end to the other, straight from node to node, and back.
        way = ["R2_IN"]
        while way[-1] != "R2_OUT":
            ahead = [edge["node"] for edge in nodes[way[-1]]["edges"] if edge["node"] not in way]
            way.append(ahead[0])
            self.assertIn(way[-2], [edge["node"] for edge in nodes[way[-1]]["edges"]])
        self.assertEqual([places[name] for name in way], [p for p in aisle if p in places.values()])
        self.assertEqual({p["x"] for p in nodes["R2_IN"]["verts"]} & {1.5, -1.5}, {1.5, -1.5})  # half of 3.0 m

    def test_keep_outs_are_wider_than_what_stands_there(self):
        self.assertIn("--keep-out 0.5", self.run_export("geojson", "--layer", "keep-outs", out="a.geojson").stderr)
        self.export("geojson", "--layer", "keep-outs", "--keep-out", "0.5", out="a.geojson")
        with open(self.out) as file:
            features = json.load(file)["features"]
        self.assertEqual(len(features), len(THINGS))
        for feature in features:
            ring = feature["geometry"]["coordinates"][0]
            north_m = (max(p[1] for p in ring) - min(p[1] for p in ring)) * 111320 * 0.9958
            self.assertAlmostEqual(north_m, 0.12 + 2 * 0.5, delta=0.05, msg=feature)

    def test_a_grid_for_map_server(self):
        self.write_graph()
        said = self.export("grid", out="a.yaml")
        self.assertEqual(said.split(), [self.out, self.out.replace(".yaml", ".pgm")])
        with open(self.out) as file:
            grid = yaml.safe_load(file)
        self.assertEqual((grid["image"], grid["negate"], grid["mode"]), ("a.pgm", 0, "trinary"))
        subprocess.run(["gdal_translate", "-q", "-of", "ENVI", self.folder + "/out/" + grid["image"],
                        self.folder + "/raw"], check=True)
        with open(self.folder + "/raw.hdr") as header:
            sizes = dict(line.split("=") for line in header if "=" in line)
        image = numpy.fromfile(self.folder + "/raw", numpy.uint8).reshape(int(sizes["lines   "]), -1)

        def at(x, y):  # map_server: the origin is the lower left corner, the first line the upper one
            column = int((x - grid["origin"][0]) / grid["resolution"])
            return image[image.shape[0] - 1 - int((y - grid["origin"][1]) / grid["resolution"]), column]

        for x, y in THINGS.values():
            self.assertEqual(at(x, y), 0)
            self.assertEqual(at(x, y + 0.15), 205)  # the thing is 0.12 m wide
        for x in range(1, 19):
            self.assertEqual((at(x, 7.5), at(x, 8.8), at(x, 10.5)), (254, 254, 205), x)
        occupied = (1 - image / 255.0) > grid["occupied_thresh"]
        free = (1 - image / 255.0) < grid["free_thresh"]
        self.assertTrue((occupied == (image == 0)).all() and (free == (image == 254)).all())

    def test_a_path_for_kitti(self):
        self.export("kitti", out="a.txt")
        poses = numpy.loadtxt(self.out).reshape(-1, 3, 4)
        with open(self.map + "/trajectory.csv") as file:
            path = list(csv.DictReader(file))
        self.assertEqual(len(poses), len(path))
        for pose, row in zip(poses, path):
            self.assertTrue(numpy.allclose(pose[:, 3], [float(row["x_m"]), float(row["y_m"]), 0]))
            self.assertAlmostEqual(math.atan2(pose[1, 0], pose[0, 0]), float(row["yaw_rad"]), 6)
            self.assertTrue(numpy.allclose(pose[:, :3] @ pose[:, :3].T, numpy.eye(3), atol=1e-6))

    def test_a_map_without_a_datum(self):
        self.write_map(georeferenced=False)
        for word in NAMES:
            if word in ("geojson", "kml"):
                done = self.run_export(word)
                self.assertEqual(done.returncode, 3, word)
                self.assertIn("only latitude and longitude", done.stderr)
                self.assertFalse(os.path.exists(self.out))
                continue
            self.assertIn("not georeferenced", self.export(word))
            layer = {"dxf": ["entities", "-where", "Text IS NULL AND Layer IN ('tree', 'object')"],
                     "csv": []}.get(word, ["landmarks"])
            rows = self.read(layer)
            if word == "csv":
                rows = [{**r, "X": r["x_m"], "Y": r["y_m"]} for r in rows]
            self.check_things(rows, THINGS, lambda x, y: (x, y), 1e-4, word)

    def test_what_is_refused(self):
        self.export("csv")
        for arguments, code, words in (
                ({"word": "csv"}, 3, "--overwrite"),
                ({"word": "shp", "out": "a.zip"}, 3, "NAME.shp.zip or NAME.shp"),
                ({"word": "gpkg", "out": "../map/map.gpkg"}, 3, "must not be overwritten"),
                ({"word": "isoxml", "out": "a.xml"}, 2, "isoxml")):
            done = self.run_export(**arguments)
            self.assertEqual(done.returncode, code, arguments)
            self.assertIn(words, done.stderr)
        self.export("csv", "--overwrite")
        self.edit("delete", str(DELETED))
        self.export("csv", "--as-mapped", "--overwrite")
        self.assertEqual(len(self.read([])), len(THINGS))


if __name__ == "__main__":
    if shutil.which("ogr2ogr") is None:
        print("skipped: ogr2ogr is not installed (package gdal-bin)")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])

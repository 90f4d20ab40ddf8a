# SPDX-License-Identifier: BSD-3-Clause
"""qgis_test.py BIN [PICTURES]: QGIS opens a map's files and PostGIS, in colours and with labels, and edits them.

Two rows of trees with two posts and a bush are exported, on the earth and without it, and published; QGIS
(Debian's, without a window) opens each layer by itself and draws it. Trees are edited and tasks ticked in QGIS's
own edit sessions and brought back. PICTURES: a folder for what it drew."""

import csv
import json
import os
import subprocess
import sys
import tempfile

os.environ["QT_QPA_PLATFORM"] = "offscreen"
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "publish"))
try:
    from qgis.core import (QgsApplication, QgsCoordinateReferenceSystem, QgsCoordinateTransform, QgsDataSourceUri,
                           QgsFeature, QgsGeometry, QgsMapRendererParallelJob, QgsMapSettings, QgsPointXY, QgsProject,
                           QgsVectorLayer)
    from qgis.PyQt.QtCore import QSize
    from qgis.PyQt.QtGui import QColor
except ImportError:
    print("skipped: no QGIS (scripts/test.sh --all installs it)", file=sys.stderr)
    sys.exit(77)
import server as postgres  # noqa: E402
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import maps  # noqa: E402

ORCHARD = os.path.join(sys.argv[1], "orchard")
DATUM = maps.datum(-27.6, 151.9, 500.0, yaw_rad=0.3)
NUM_ROWS, NUM_PLACES, GAP = 2, 8, (1, 5)
# The colours that the page of map layers promises, as QGIS lays them on white.
GREEN, RED = (46, 125, 50), (198, 40, 40)
WIDTH, HEIGHT = 1000, 600


def orchard(*arguments):
    done = subprocess.run([ORCHARD, *arguments], stdout=subprocess.PIPE, text=True)
    assert done.returncode == 0, (arguments, done.returncode, done.stdout)
    return done.stdout


def write_map(folder, georeference):
    places = [(row, place) for row in range(1, NUM_ROWS + 1) for place in range(1, NUM_PLACES + 1) if (row, place) != GAP]
    lines = [maps.landmark(number, 3 * place, 5 * row, row, place) for number, (row, place) in enumerate(places, 1)]
    for x_m, y_m, width_m in ((4.5, 5.0, 0.2), (13.5, 10.0, 0.2), (16.5, 7.6, 1.4)):
        lines.append(maps.landmark(len(lines) + 1, x_m, y_m, width_m=width_m, kind="object"))
    maps.write_map(folder, lines, georeference=DATUM if georeference else None)


def drawn(layers, picture=None):
    """What QGIS draws of layers over the first one's extent."""
    settings = QgsMapSettings()
    settings.setLayers(layers)
    settings.setBackgroundColor(QColor(255, 255, 255))
    settings.setOutputSize(QSize(WIDTH, HEIGHT))
    settings.setOutputDpi(96)
    # On the ground: degrees would draw it wider than it is.
    crs = layers[0].crs()
    if crs.isGeographic():
        crs = QgsCoordinateReferenceSystem("EPSG:32756")
    settings.setDestinationCrs(crs)
    extent = QgsCoordinateTransform(layers[0].crs(), crs, QgsProject.instance()).transformBoundingBox(layers[0].extent())
    extent.grow(1.5)
    settings.setExtent(extent)
    job = QgsMapRendererParallelJob(settings)
    job.start()
    job.waitForFinished()
    image = job.renderedImage()
    if picture and len(sys.argv) > 2:
        image.save(os.path.join(sys.argv[2], picture + ".png"))
    return image


def num_pixels(image, colour):
    return sum(all(abs(got - wanted) < 12 for got, wanted in zip(image.pixelColor(x, y).getRgb(), colour))
               for x in range(image.width()) for y in range(image.height()))


def num_different(a, b):
    return sum(a.pixel(x, y) != b.pixel(x, y) for x in range(a.width()) for y in range(a.height()))


def check_trees(layer, others, picture):
    """Trees green, objects red, each with its number."""
    assert layer.isValid(), layer.error().message()
    assert layer.crs().isValid(), "QGIS would ask for a coordinate system"
    trees = NUM_ROWS * NUM_PLACES - 1
    assert layer.featureCount() == trees + 3, layer.featureCount()
    assert layer.renderer().type() == "categorizedSymbol" and layer.labelsEnabled()
    image = drawn([layer, *others], picture)
    # A marker of 2.4 mm at 96 dpi has some 50 pixels, a square of 2 mm as many.
    green, red = num_pixels(image, GREEN), num_pixels(image, RED)
    assert green > 20 * trees and red > 20 * 3, (green, red)
    layer.setLabelsEnabled(False)
    labels = num_different(image, drawn([layer, *others]))
    layer.setLabelsEnabled(True)
    # A label has three digits and more, each of some ten dark pixels, and its white buffer.
    assert labels > 30 * trees, labels
    print(f"ok: {picture}: {green} green pixels, {red} red ones, {labels} of labels")


def check_geopackage(folder, name, georeference):
    write_map(f"{folder}/{name}", georeference)
    path = f"{folder}/{name}.gpkg"
    orchard("export", f"{folder}/{name}", "--format", "gpkg", "--out", path)
    layers = {}
    for kind in ("landmarks", "rows", "gaps", "extents"):
        layers[kind] = QgsVectorLayer(f"{path}|layername={kind}", kind, "ogr")
        assert layers[kind].isValid() and layers[kind].crs().isValid(), kind
        assert layers[kind].featureCount() > 0, kind
    assert layers["landmarks"].crs().isGeographic() is False
    check_trees(layers["landmarks"], [layers["gaps"], layers["extents"], layers["rows"]], name)
    one = drawn([layers["landmarks"]])
    for kind in ("rows", "gaps", "extents"):
        assert num_different(one, drawn([layers["landmarks"], layers[kind]])) > 20, kind + " are not drawn"


def opened(path, name=None):
    layer = QgsVectorLayer(f"{path}|layername={name}" if name else path, name or "layer", "ogr")
    assert layer.isValid() and layer.crs().isValid(), path
    return layer


def feature(layer, column, value):
    found = [f for f in layer.getFeatures() if f[column] == value]
    assert len(found) == 1, (column, value, len(found))
    return found[0]


class editing:
    """An edit session as by QGIS's pencil and its saving."""
    def __init__(self, layer):
        self.layer = layer

    def __enter__(self):
        assert self.layer.startEditing(), "QGIS cannot edit it"
        return self.layer

    def __exit__(self, kind, *_):
        if kind is None:
            assert self.layer.commitChanges(), self.layer.commitErrors()

    def put(self, found, column, value):
        assert self.layer.changeAttributeValue(found.id(), self.layer.fields().indexFromName(column), value)


def choices(layer, column):
    """What QGIS's form offers for a column."""
    setup = layer.editorWidgetSetup(layer.fields().indexFromName(column))
    assert setup.type() == "ValueMap", (column, setup.type())
    return [list(choice.values())[0] for choice in setup.config()["map"]]


def check_edits(folder, name, georeference):
    """QGIS's own cycle: opened and saved as it is says nothing; each kind of edit comes back as it was made."""
    map_folder, path = f"{folder}/{name}", f"{folder}/{name}.gpkg"
    write_map(map_folder, georeference)
    orchard("export", map_folder, "--format", "gpkg", "--out", path)

    def imported(*words):
        return json.loads(orchard("import-edits", map_folder, path, "--who", "Ana", "--json", *words))["counts"]

    layer = opened(path, "landmarks")
    assert choices(layer, "class") == ["tree", "object", "unseen"]
    session = editing(layer)
    with session:
        session.put(feature(layer, "id", 1), "note", None)
    del session, layer
    assert not any(imported("--dry-run").values()), "nothing was edited"

    layer = opened(path, "landmarks")
    session = editing(layer)
    with session:
        layer.deleteFeature(feature(layer, "id", 2).id())
        moving = feature(layer, "id", 3)
        place = moving.geometry().asPoint()
        layer.changeGeometry(moving.id(), QgsGeometry.fromPointXY(QgsPointXY(place.x() + 0.4, place.y() - 0.3)))
        session.put(feature(layer, "id", 4), "class", "object")
        session.put(feature(layer, "id", 5), "note", "grafted, 2 años")
        new = QgsFeature(layer.fields())
        new.setGeometry(QgsGeometry.fromPointXY(QgsPointXY(place.x() + 1.1, place.y() + 1.3)))
        new["class"] = "tree"
        assert layer.addFeature(new)
    rows = opened(path, "rows")
    session_of_rows = editing(rows)
    with session_of_rows:
        session_of_rows.put(feature(rows, "row", 2), "label", "A-Sur")
    del session, session_of_rows, layer, rows
    counts = imported()
    assert counts == {"delete": 1, "move": 1, "class": 1, "note": 1, "add": 1, "row": 1}, counts
    orchard("edit", "apply", map_folder, "--out", folder + "/" + name + "_after")
    by_id = {int(row["id"]): row for row in maps.rows_of(f"{folder}/{name}_after/map.csv")}
    before = {int(row["id"]): row for row in maps.rows_of(f"{map_folder}/map.csv")}
    assert 2 not in by_id and by_id[4]["class"] == "object" and len(by_id) == len(before)
    moved = [float(by_id[3][axis]) - float(before[3][axis]) for axis in ("x_m", "y_m")]
    assert abs(sum(d * d for d in moved) ** 0.5 - 0.5) < 0.002, moved
    print(f"ok: edits in QGIS of {name}")


def check_tasks(folder, form):
    """A gap is a task; ticked in QGIS it stays done, with its note."""
    map_folder = f"{folder}/tasks_{form}"
    write_map(map_folder, True)
    path, later = f"{folder}/tasks.{form}", f"{folder}/later.{form}"
    orchard("tasks", map_folder, "--out", path)
    layer = opened(path, "tasks")
    assert layer.featureCount() == 1, layer.featureCount()
    if form == "gpkg":
        assert layer.renderer().type() == "categorizedSymbol"
        assert choices(layer, "state") == ["open", "done"]
        drawn([layer], "tasks")
    session = editing(layer)
    with session:
        task = feature(layer, "tree", GAP[1])
        assert (str(task["row"]), task["what"], task["state"]) == (str(GAP[0]), "plant", "open")
        session.put(task, "state", "done")
        session.put(task, "note", "Gala")
    del session, layer
    told = json.loads(orchard("tasks", map_folder, "--ticked", path, "--out", later, "--json"))
    assert (told["open"], told["done"]) == (0, 1), told
    task = feature(opened(later, "tasks"), "tree", GAP[1])
    assert (task["state"], task["note"]) == ("done", "Gala")
    print(f"ok: tasks ticked in QGIS as {form}")


def check_other_files(folder):
    """What else is exported opens in QGIS, at the place of the GeoPackage's trees."""
    map_folder = f"{folder}/others"
    write_map(map_folder, True)
    orchard("export", map_folder, "--format", "gpkg", "--out", folder + "/others.gpkg")
    project = QgsProject.instance()
    trees = opened(folder + "/others.gpkg", "landmarks")
    geographic = QgsCoordinateReferenceSystem("EPSG:4326")
    extent = QgsCoordinateTransform(trees.crs(), geographic, project).transformBoundingBox(trees.extent())
    extent.grow(3e-5)
    for form, file, layers in (("kml", "others.kml", None), ("geojson", "others.geojson", ""), ("gpx", "others.gpx", "waypoints"),
                               ("shp", "others.shp", "")):
        orchard("export", map_folder, "--format", form, "--out", f"{folder}/{file}")
        layer = QgsVectorLayer(f"{folder}/{file}", file, "ogr")
        if layers is None:
            parts = [sub.split("!!::!!") for sub in layer.dataProvider().subLayers()]
            names = [part[1] for part in parts if part[2] != "0"]
            assert {"landmarks", "rows", "gaps"} <= set(names), names
        else:
            names = [layers]
        count = 0
        for name in names:
            layer = opened(f"{folder}/{file}", name)
            count += layer.featureCount()
            box = QgsCoordinateTransform(layer.crs(), geographic, project).transformBoundingBox(layer.extent())
            assert extent.contains(box), (file, name, box.toString(), extent.toString())
        print(f"ok: {file} in QGIS: {count} features")


def check_postgis(folder):
    with postgres.Server() as db:
        orchard("publish", f"{folder}/geopackage_utm", "--to", db.url(), "--block", "north", "--date", "2026-04-10")
        write_map(f"{folder}/autumn", True)
        text = open(f"{folder}/autumn/map.csv", encoding="ascii").read().replace(",0.1200,", ",0.1230,")
        with open(f"{folder}/autumn/map.csv", "w", encoding="ascii") as file:
            file.write(text)
        orchard("publish", f"{folder}/autumn", "--to", db.url(), "--block", "north", "--date", "2026-10-02")
        for table in ("tree", "tree_now"):
            uri = QgsDataSourceUri()
            uri.setConnection(db.folder, "", "orchard", "owner", "")
            # The table holds both dates, the view the last alone.
            filter_by = "" if table == "tree_now" else "date = '2026-10-02'"
            uri.setDataSource("orchard", table, "place", filter_by, "block,id" if table == "tree_now" else "")
            layer = QgsVectorLayer(uri.uri(False), table, "postgres")
            check_trees(layer, [], "postgis_" + table)
            del layer
        db.sql("CREATE VIEW growth AS SELECT t.id, t.place, 1000 * (t.width_m - s.width_m) AS growth_mm FROM orchard.tree s "
               "JOIN orchard.tree t ON t.block = s.block AND t.id = s.id WHERE s.date = '2026-04-10' AND "
               "t.date = '2026-10-02' AND t.\"row\" IS NOT NULL")
        uri = QgsDataSourceUri()
        uri.setConnection(db.folder, "", "orchard", "owner", "")
        uri.setDataSource("public", "growth", "place", "", "id")
        layer = QgsVectorLayer(uri.uri(False), "growth", "postgres")
        grown = [f["growth_mm"] for f in layer.getFeatures()]
        assert len(grown) == NUM_ROWS * NUM_PLACES - 1 and all(abs(mm - 3.0) < 0.01 for mm in grown), grown
        print("ok: a view of two seasons in QGIS")
        del layer


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.environ["HOME"] = folder
        application = QgsApplication([], False)
        application.initQgis()
        check_geopackage(folder, "geopackage_utm", True)
        check_geopackage(folder, "geopackage_local", False)
        with open(f"{folder}/geopackage_utm/map.csv", encoding="ascii") as file:
            assert len(list(csv.DictReader(file))) == NUM_ROWS * NUM_PLACES + 2
        check_edits(folder, "edited_utm", True)
        check_edits(folder, "edited_local", False)
        check_tasks(folder, "gpkg")
        check_tasks(folder, "geojson")
        check_other_files(folder)
        check_postgis(folder)
        application.exitQgis()


main()

# SPDX-License-Identifier: BSD-3-Clause
"""qgis_test.py BIN [PICTURES]: QGIS opens a map's GeoPackage and PostGIS, in colours and with labels.

Two rows of trees with two posts and a bush are exported, on the earth and without it, and published; QGIS
(Debian's, without a window) opens each layer by itself and draws it. PICTURES: a folder for what it drew."""

import csv
import os
import subprocess
import sys
import tempfile

os.environ["QT_QPA_PLATFORM"] = "offscreen"
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "publish"))
try:
    from qgis.core import (QgsApplication, QgsCoordinateReferenceSystem, QgsCoordinateTransform, QgsDataSourceUri,
                           QgsMapRendererParallelJob, QgsMapSettings, QgsProject, QgsVectorLayer)
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
    subprocess.run([ORCHARD, *arguments], check=True, stdout=subprocess.DEVNULL)


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


def check_postgis(folder):
    with postgres.Server() as db:
        orchard("publish", f"{folder}/geopackage_utm", "--to", db.url(), "--block", "north", "--date", "2026-04-10")
        for table in ("tree", "tree_now"):
            uri = QgsDataSourceUri()
            uri.setConnection(db.folder, "", "orchard", "owner", "")
            uri.setDataSource("orchard", table, "place", "", "block,id" if table == "tree_now" else "")
            layer = QgsVectorLayer(uri.uri(False), table, "postgres")
            check_trees(layer, [], "postgis_" + table)
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
        check_postgis(folder)
        application.exitQgis()


main()

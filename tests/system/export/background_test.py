# SPDX-License-Identifier: BSD-3-Clause
"""orchard edit background: an orthophoto lies where the trees are. Usage: background_test.py BIN.

The photo is drawn here in UTM, a red square on each tree, where GDAL's own program puts its latitude and longitude;
the map's frame is turned and lies 500 m high."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "view"))
import browser  # noqa: E402
import maps  # noqa: E402

ORCHARD = sys.argv[1] + "/orchard"
UTM, PIXEL_M, HALF_M, AROUND_M = "EPSG:32756", 0.1, 0.6, 15.0
TREES = [(3.0 * k, 5.0 * row) for row in (1, 2, 3) for k in range(1, 9)]
GREEN, RED = bytes((90, 130, 60)), bytes((220, 30, 30))


def run(*words, **more):
    return subprocess.run(words, check=True, capture_output=True, **more).stdout


def picture_of(path, folder):
    """Width, height and pixels of a picture, by GDAL."""
    run("gdal_translate", "-q", "-of", "PNM", path, folder + "/seen.ppm")
    with open(folder + "/seen.ppm", "rb") as file:
        head, size, most, pixels = file.read().split(b"\n", 3)
    assert (head, most) == (b"P6", b"255")
    width, height = map(int, size.split())
    return width, height, pixels


class Background(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="orchard_background_")
        self.addCleanup(temporary.cleanup)
        self.folder = temporary.name
        self.map = self.folder + "/map"
        lines = [maps.landmark(i, x, y, 1 + i // 8, 1 + i % 8) for i, (x, y) in enumerate(TREES)]
        maps.write_map(self.folder + "/raw", lines, [(0.0, 2.5, 0.0), (28.0, 2.5, 0.0)],
                       maps.datum(-27.6, 151.9, 500.0, yaw_rad=0.3))
        run(ORCHARD, "edit", "apply", self.folder + "/raw", "--out", self.map)
        self.draw()

    def draw(self):
        run(ORCHARD, "export", self.map, "--format", "geojson", "--out", self.folder + "/trees.geojson")
        with open(self.folder + "/trees.geojson", encoding="utf-8") as file:
            degrees = [f["geometry"]["coordinates"] for f in json.load(file)["features"]]
        text = "".join(f"{x} {y}\n" for x, y in degrees)
        places = [tuple(map(float, line.split()[:2])) for line in
                  run("gdaltransform", "-s_srs", "EPSG:4326", "-t_srs", UTM, input=text.encode()).decode().splitlines()]
        west, north = min(x for x, _ in places) - AROUND_M, max(y for _, y in places) + AROUND_M
        width = int((max(x for x, _ in places) + AROUND_M - west) / PIXEL_M)
        height = int((north - min(y for _, y in places) + AROUND_M) / PIXEL_M)
        pixels = bytearray(GREEN * (width * height))
        for x, y in places:
            half = int(HALF_M / PIXEL_M)
            column, row = int((x - west) / PIXEL_M), int((north - y) / PIXEL_M)
            for r in range(row - half, row + half):
                begin = 3 * (r * width + column - half)
                pixels[begin:begin + 3 * 2 * half] = RED * (2 * half)
        with open(self.folder + "/ortho.ppm", "wb") as file:
            file.write(b"P6\n%d %d\n255\n" % (width, height) + pixels)
        corners = [str(v) for v in (west, north, west + width * PIXEL_M, north - height * PIXEL_M)]
        run("gdal_translate", "-q", "-a_srs", UTM, "-a_ullr", *corners, self.folder + "/ortho.ppm", self.folder + "/ortho.tif")

    def lay(self, picture):
        return subprocess.run([ORCHARD, "edit", "background", self.map, f"{self.folder}/{picture}"], capture_output=True,
                              text=True)

    def check_where_the_trees_are(self, folder):
        with open(folder + "/background.json", encoding="ascii") as file:
            x0, y0, x1, y1 = json.load(file)["box_m"]
        width, height, pixels = picture_of(folder + "/background.jpg", self.folder)

        def red(x, y):
            column, row = int((x - x0) / (x1 - x0) * width), int((y1 - y) / (y1 - y0) * height)
            r, g, _ = pixels[3 * (row * width + column):][:3]
            return r > 180 and g < 80
        for x, y in TREES:
            self.assertTrue(red(x, y), (x, y))
            # The square is turned, and JPEG blurs its border.
            self.assertTrue(red(x + 0.35, y) and red(x, y - 0.35), (x, y))
            self.assertFalse(red(x + 1.0, y) or red(x - 1.0, y) or red(x, y + 1.0) or red(x, y - 1.0), (x, y))

    def test_an_orthophoto_and_tiles(self):
        for picture in ("ortho.tif", "ortho.mbtiles"):
            if picture.endswith("mbtiles"):
                run("gdal_translate", "-q", "-of", "MBTILES", self.folder + "/ortho.tif", f"{self.folder}/{picture}")
            done = self.lay(picture)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.check_where_the_trees_are(self.map)
            with open(self.map + "/map.html", encoding="utf-8") as file:
                self.assertEqual(file.read().count('"background":{"box":['), 1, "none twice")
        # Corrected maps keep it.
        run(ORCHARD, "edit", "apply", self.map, "--out", self.folder + "/after")
        self.check_where_the_trees_are(self.folder + "/after")
        with open(self.folder + "/after/map.html", encoding="utf-8") as file:
            self.assertEqual(file.read().count('"background":{"box":['), 1)

    @unittest.skipUnless(shutil.which("chromedriver"), "no Chromium (scripts/install_deps.sh --tests)")
    def test_the_page_draws_it_beneath(self):
        self.assertEqual(self.lay("ortho.tif").returncode, 0)
        page = browser.Browser()
        self.addCleanup(page.close)
        page.open("file://" + self.map + "/map.html")
        page.wait("return !!orchardApp.model.background", "the picture")
        x, y = TREES[9]
        pixel = """const [x, y] = arguments, { canvas, view } = orchardApp; orchardApp.view.zoomAt(640, 400, 3);
            orchardApp.goTo(x, y); orchardApp.paintNow();
            return [...canvas.getContext('2d').getImageData(view.toScreenX(x + 0.3), view.toScreenY(y + 0.25), 1, 1).data];"""
        red, green, _, _ = page.run(pixel, x, y)
        self.assertTrue(red > 180 and green < 80, (red, green))
        page.run("document.querySelector('#legend input[data-layer=background]').click()")
        red, green, _, _ = page.run(pixel, x, y)
        self.assertTrue(green > 180, (red, green))
        self.assertEqual([e for e in page.errors() if "willReadFrequently" not in e], [])

    def test_what_has_no_place(self):
        with open(self.map + "/map.html", "rb") as file:
            before = file.read()
        run("gdal_translate", "-q", self.folder + "/ortho.ppm", self.folder + "/nowhere.tif")
        run("gdal_translate", "-q", "-a_srs", UTM, "-a_ullr", "400000", "6900100", "400100", "6900000",
            self.folder + "/ortho.ppm", self.folder + "/elsewhere.tif")
        with open(self.folder + "/ortho.tif", "rb") as file:
            whole = file.read()
        with open(self.folder + "/cut.tif", "wb") as file:
            file.write(whole[:len(whole) // 3])
        for picture, words in (("nowhere.tif", "coordinate system"), ("elsewhere.tif", "shows nothing of the map's place"),
                               ("cut.tif", "cut.tif"), ("trees.geojson", "is not a GeoTIFF"), ("none.tif", "none.tif")):
            done = self.lay(picture)
            self.assertEqual(done.returncode, 3, (picture, done.stderr))
            self.assertIn(words, done.stderr)
        with open(self.map + "/map.html", "rb") as file:
            self.assertEqual(file.read(), before)
        with open(self.map + "/background.jpg", "wb") as file:
            file.write(b"x")
        done = subprocess.run([ORCHARD, "edit", "apply", self.map, "--out", self.folder + "/after"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 3)
        self.assertIn("orchard edit background", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

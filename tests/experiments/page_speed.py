#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""page_speed.py MAP_HTML: pictures per second while the page pans over 100,000 trees, at several
zooms, in Chromium without a graphics card. MAP_HTML: any map.html, whose page is taken with other data."""

import json
import os
import random
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "system", "view"))
import browser  # noqa: E402

NUM_ROWS, NUM_PLACES = 250, 400

PAN = """
const [zoom, done] = arguments, app = orchardApp;
app.fit();
app.view.zoomAt(640, 400, zoom);
let pictures = 0, begin = 0;
function step(now) {
  if (!begin) begin = now;
  app.view.moveBy(3, 2);
  app.paintNow();
  if (++pictures < 90) requestAnimationFrame(step); else done(1000 * (pictures - 1) / (now - begin));
}
requestAnimationFrame(step);"""


def orchard_data():
    chance = random.Random(1)
    landmarks = {name: [] for name in ("id", "label", "x", "y", "n", "roc", "probability", "se_x", "se_y", "width", "row",
                                       "position")}
    rows = []
    for row in range(NUM_ROWS):
        line = []
        for place in range(NUM_PLACES):
            x, y = round(4.5 * row + chance.gauss(0, 0.1), 3), round(2.5 * place + chance.gauss(0, 0.1), 3)
            line += [x, y]
            values = (row * NUM_PLACES + place + 1, int(chance.random() < 0.03), x, y, 30, 0.83,
                      round(chance.uniform(0.7, 1), 3), 0.004, 0.004, 0.12, row + 1, place + 1)
            for column, value in zip(landmarks.values(), values):
                column.append(value)
        rows.append({"number": row + 1, "spacing": 2.5, "line": line, "gaps": []})
    path = [value for row in range(NUM_ROWS) for value in
            (4.5 * row + 2.25, 1000 * (row % 2), 4.5 * row + 2.25, 1000 * (1 - row % 2))]
    return {"title": "100,000 trees", "version": "", "first_utime": 0, "last_utime": 0, "warnings": [],
            "landmarks": landmarks, "rows": rows, "ways": [], "paths": [path]}


def main():
    browser.require_chromium()
    with open(sys.argv[1], encoding="utf-8") as file:
        page = file.read()
    mark = '<script id="map-data" type="application/json">'
    begin = page.index(mark) + len(mark)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "map.html")
        with open(path, "w", encoding="utf-8") as file:
            file.write(page[:begin] + json.dumps(orchard_data()) + page[page.index("</script>", begin):])
        with browser.Browser(1280, 900) as chromium:
            chromium.open("file://" + path)
            print(f"ready after {chromium.run('return performance.now()') / 1000:.1f} s")
            for zoom in (1, 2.5, 6, 20):
                print(f"zoom {zoom}: {chromium.run_async(PAN, zoom):.0f} pictures per second")


main()

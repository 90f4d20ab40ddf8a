#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""map_page_test.py BIN: map.html in a browser, from a disk: what it shows is what map.csv says, at the
width of a desk and of a telephone; nobody is asked for anything, and no name is executed."""

import base64
import csv
import os
import subprocess
import sys
import tempfile

import browser

NASTY = "<img src=x onerror='document.title=1'><script>document.title=2<!--.lcm"


def orchard(bin_folder, *arguments):
    subprocess.run([os.path.join(bin_folder, "orchard"), *arguments], check=True, stdout=subprocess.DEVNULL)


def check_page(page, url, landmarks):
    page.open(url)
    title = page.run("return document.getElementById('title').textContent")
    assert title == NASTY, title
    trees = [row for row in landmarks if row["class"] == "tree"]
    summary = page.run("return document.getElementById('summary').textContent").replace("\u00a0", " ")
    assert f"{len(trees)} trees" in summary and "2 rows" in summary, summary

    # A click on each of a few trees, where the page draws it, shows what map.csv says of it.
    for row in trees[::5]:
        place = page.run("""
            const [x, y] = arguments, app = orchardApp;
            app.select(-1); app.goTo(x, y); app.paintNow();
            return [app.view.toScreenX(x), app.view.toScreenY(y)];""", float(row["x_m"]), float(row["y_m"]))
        page.click(*place)
        details = page.run("return document.getElementById('details').innerText")
        assert f"Row {row['row']}, tree {row['position']}" in details, (row, details)
        assert f"Id\t{row['id']}" in details, details
        assert f"{100 * float(row['width_m']):.1f} cm" in details, (row, details)
        photo = page.run("""
            const image = document.querySelector('#details img.photo');
            return image && image.decode().then(
              () => [image.naturalWidth, image.naturalHeight, image.src.split(',')[1]], String);""")
        with open(os.path.join(os.path.dirname(url.replace("file://", "")), "album", row["id"] + ".jpg"), "rb") as jpeg:
            assert photo and photo[2] == base64.b64encode(jpeg.read()).decode(), photo
        assert photo[0] > 10 and photo[1] > 10, photo
    page.run("orchardApp.select(-1)")

    # Searches find the same; what there is not is said.
    row = trees[-1]
    for query in (f"row {row['row']} tree {row['position']}", f"{row['row']}/{row['position']}", f"id {row['id']}",
                  f"#{row['id']}", f"ROW {row['row']}, {row['position']}"):
        page.run("orchardApp.select(-1)")
        page.type_into("#query", query + "\n")
        found = page.run("return orchardApp.selectedId")
        assert found == int(row["id"]), (query, found)
    page.type_into("#query", "row 99 tree 1\n")
    assert "no row 99" in page.run("return document.getElementById('found').textContent")

    # Dragging moves the map under the mouse, as far as the mouse.
    before = page.run("orchardApp.select(-1); orchardApp.fit(); return [orchardApp.view.toScreenX(0), orchardApp.view.toScreenY(0)]")
    page.drag(*page.run("return [innerWidth / 2 | 0, innerHeight * 0.8 | 0]"), -60, 40)
    after = page.run("return [orchardApp.view.toScreenX(0), orchardApp.view.toScreenY(0)]")
    assert abs(after[0] - before[0] + 60) < 3 and abs(after[1] - before[1] - 40) < 3, (before, after)

    # Everything is within the width of the page.
    assert page.run("return document.documentElement.scrollWidth <= innerWidth")
    assert page.run("""return [...document.querySelectorAll('.card:not([hidden])')].every((card) => {
        const box = card.getBoundingClientRect();
        return box.left >= 0 && box.right <= innerWidth && box.top >= 0 && box.bottom <= innerHeight + 1; })""")
    # The canvas shows something of each class: pixels of its colour.
    shown = page.run("""
        const app = orchardApp; app.fit(); app.paintNow();
        const data = app.canvas.getContext('2d').getImageData(0, 0, app.canvas.width, app.canvas.height).data;
        const number = (colour) => { const v = parseInt(colour.slice(1), 16); let n = 0;
          for (let k = 0; k < data.length; k += 4) {
            if (data[k] === v >> 16 && data[k + 1] === ((v >> 8) & 255) && data[k + 2] === (v & 255)) ++n; }
          return n; };
        return [number(app.theme.colours.tree), number(app.theme.colours.object)];""")
    assert min(shown) > 20, shown
    # The ground is shaded where heights are known, once that is switched on.
    assert page.run("return document.querySelector('[data-layer=heights]')") is None
    looks = page.run("""
        const app = orchardApp, c = app.model.columns;
        c.x.forEach((x, i) => { c.z[i] = 10 + x; c.z_sd[i] = i === 0 ? 0 : 0.1; });
        app.model.touch(); app.showAll(); app.paintNow();
        const plain = app.canvas.toDataURL(), box = document.querySelector('[data-layer=heights]');
        box.click(); app.paintNow();
        const most = Math.max(...c.z.filter((_, i) => c.z_sd[i] > 0)).toFixed(1);
        return [plain !== app.canvas.toDataURL(), box.parentElement.textContent.includes(`to ${most}\u00a0m`)];""")
    assert looks == [True, True], looks
    assert page.run("return document.title") == NASTY, "a name was executed"
    assert page.errors() == [], page.errors()
    requests = page.requests()
    assert requests == [url], requests


def main():
    browser.require_chromium()
    with tempfile.TemporaryDirectory() as folder:
        bin_folder = sys.argv[1]
        log = os.path.join(folder, NASTY)
        orchard(bin_folder, "simulate", "--scene", "tubes", "--seed", "3", "--out", log)
        orchard(bin_folder, "map", log, "--out", folder + "/map", "--quiet", "--no-derived")
        with open(folder + "/map/map.csv", encoding="ascii") as file:
            landmarks = list(csv.DictReader(file))
        url = f"file://{folder}/map/map.html"
        for width, height, dark in ((1280, 800, False), (390, 844, True)):
            with browser.Browser(width, height, dark) as page:
                check_page(page, url, landmarks)
            print(f"ok: {width} pixels wide")


main()

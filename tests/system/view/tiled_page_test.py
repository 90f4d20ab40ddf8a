#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tiled_page_test.py BIN [PICTURES]: the page of a map of more than 100,000 trees, from a server and from a disk: it begins
with an overview, loads what is in view, and finds, steps to and shows every tree as map.csv has it. PICTURES: a folder for
pictures of what the browser showed."""

import csv
import gzip
import os
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import browser  # noqa: E402
import maps  # noqa: E402
from served import Served  # noqa: E402

NUM_ROWS, NUM_PLACES, ROW_M, TREE_M = 252, 400, 4.0, 2.0
READY = "return orchardApp.tiles.pending.size === 0 && !orchardApp.isDue"


def write_map(folder):
    """Rows of trees, planted to 10 cm, driven along every aisle."""
    dice = random.Random(5)
    lines = (maps.landmark(NUM_PLACES * row + place + 1, TREE_M * place + dice.gauss(0, 0.1), ROW_M * row + dice.gauss(0, 0.1), row + 1,
                           place + 1, dice.gauss(0.12, 0.01), num=60) for row in range(NUM_ROWS) for place in range(NUM_PLACES))
    length_m = int(TREE_M * NUM_PLACES)
    maps.write_map(folder, lines, ((step if aisle % 2 == 0 else length_m - step, ROW_M * (aisle - 0.5), 3.14159 * (aisle % 2))
                                   for aisle in range(NUM_ROWS + 1) for step in range(0, length_m, 4)))


def trees_of(folder):
    with open(folder + "/map.csv", encoding="ascii") as file:
        return list(csv.DictReader(file))


def go_to(page, tree):
    page.run("orchardApp.select(-1); orchardApp.goTo(arguments[0], arguments[1]); orchardApp.paintNow()",
             float(tree["x_m"]), float(tree["y_m"]))
    page.wait(READY, "the tiles in view")


def check_details(page, tree):
    details = page.run("return document.getElementById('details').innerText")
    assert f"Row {tree['row']}, tree {tree['position']}" in details and f"Id\t{tree['id']}" in details, (tree, details)
    assert f"{100 * float(tree['width_m']):.1f} cm" in details, (tree, details)


def check_page(page, url, trees, pictures):
    page.open(url)
    page.wait(READY, "the page")
    text = page.run("return document.documentElement.outerHTML.length")
    assert text < 1e6, f"the first page has {text} characters"
    summary = page.run("return document.getElementById('summary').textContent").replace("\u00a0", " ")
    assert f"{len(trees):,} trees" in summary, summary
    assert page.run("return orchardApp.model.count") == 0, "the overview needs no tree"
    if pictures:
        page.picture(f"{pictures}/overview_{url.split(':')[0]}.png")
    # In the middle of the orchard the layer of trees changes every pixel.
    shaded = page.run("""
        const { canvas, view } = orchardApp, [left, low, right, high] = orchardApp.model.box;
        const at = [view.toScreenX((left + right) / 2) | 0, view.toScreenY((low + high) / 2) | 0];
        const pixels = (isShown) => {
          orchardApp.painter.shown.trees = isShown; orchardApp.paintNow();
          return canvas.getContext('2d').getImageData(at[0] - 20, at[1] - 20, 40, 40).data; };
        const without = pixels(false), data = pixels(true);
        let n = 0;
        for (let k = 0; k < data.length; k += 4) n += Math.abs(data[k] - without[k]) + Math.abs(data[k + 2] - without[k + 2]) > 20;
        return n;""")
    assert shaded > 1500, f"trees change {shaded} of 1600 pixels in the middle of the orchard"
    asked = [each for each in page.requests() if "tile" in each]
    assert not asked, asked

    # A click on a tree, wherever it is, shows what map.csv says of it.
    by_place = {(tree["row"], tree["position"]): tree for tree in trees}
    for tree in random.Random(1).sample(trees, 6):
        go_to(page, tree)
        page.click(*page.run("const v = orchardApp.view; return [v.toScreenX(arguments[0]), v.toScreenY(arguments[1])]",
                             float(tree["x_m"]), float(tree["y_m"])))
        check_details(page, tree)
    if pictures:
        page.picture(f"{pictures}/near_{url.split(':')[0]}.png")

    # All trees around are there, none twice: those of a box that several tiles share.
    side = page.run("return orchardApp.tiles.side")
    box = [2 * side - 20, 2 * side - 20, 2 * side + 20, 2 * side + 20]
    go_to(page, {"x_m": 2 * side, "y_m": 2 * side})
    shown = page.run("""const [box] = arguments, { columns } = orchardApp.model;
        return columns.id.filter((id, i) => columns.x[i] > box[0] && columns.y[i] > box[1] && columns.x[i] < box[2] &&
          columns.y[i] < box[3]);""", box)
    wanted = [int(tree["id"]) for tree in trees
              if box[0] < float(tree["x_m"]) < box[2] and box[1] < float(tree["y_m"]) < box[3]]
    assert sorted(shown) == wanted and len(wanted) > 150, (len(shown), len(wanted))

    # What is not in view is found; a step along the row leads across the border of a tile.
    for tree, query in ((trees[-7], "row {row} tree {position}"), (trees[11], "id {id}"), (trees[-1], "#{id}")):
        page.run("orchardApp.select(-1); document.getElementById('found').textContent = ''")
        page.type_into("#query", query.format(**tree) + "\n")
        page.wait(f"return orchardApp.selectedId === {tree['id']}", query)
        check_details(page, tree)
    page.type_into("#query", "id 999999\n")
    page.wait("return document.getElementById('found').textContent.includes('No landmark has id 999999')", "the answer")
    before = next(tree for tree in trees if float(tree["x_m"]) < side <= float(by_place[
        (tree["row"], str(int(tree["position"]) % NUM_PLACES + 1))]["x_m"]))
    after = by_place[(before["row"], str(int(before["position"]) + 1))]
    page.type_into("#query", f"id {before['id']}\n")
    page.wait(f"return orchardApp.selectedId === {before['id']}", "the tree")
    page.run("orchardApp.fit(); orchardApp.paintNow()")  # so that no neighbour is loaded
    page.run("[...document.querySelectorAll('#details button')].find((b) => b.textContent.includes('next')).click()")
    page.wait(f"return orchardApp.selectedId === {after['id']}", "the next tree")
    check_details(page, after)
    page.wait(READY, "all tiles")
    errors = [each for each in page.errors() if "willReadFrequently" not in each]  # of reading pixels twice, above
    assert not errors, errors
    return page.requests()


def check_packing(served):
    """Who takes gzip gets that, though it takes others: the library would pack by Brotli, which takes seconds."""
    plain = served.ask("/api/tile?name=0_0")[1]
    packed = served.ask("/api/tile?name=0_0", headers={"Accept-Encoding": "gzip, deflate, br, zstd"})[1]
    assert len(packed) < len(plain) / 3 and gzip.decompress(packed) == plain, (len(packed), len(plain))
    for refusing in ("br", "gzip;q=0, br", ""):
        assert served.ask("/api/tile?name=0_0", headers={"Accept-Encoding": refusing})[1] == plain, refusing


def check_correction(page, bin_folder, folder, tree):
    """A tree that somebody deletes meanwhile goes from the page."""
    go_to(page, tree)
    assert page.run(f"return orchardApp.model.withId({tree['id']})") >= 0
    subprocess.run([bin_folder + "/orchard", "edit", "delete", folder, tree["id"]], check=True, stdout=subprocess.DEVNULL)
    page.wait(f"return orchardApp.model.count > 0 && orchardApp.model.withId({tree['id']}) < 0", "the correction", 120)
    page.wait(f"return orchardApp.model.totals[0] === {NUM_ROWS * NUM_PLACES - 1}", "the number", 30)


def main():
    browser.require_chromium()
    bin_folder, pictures = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else ""
    with tempfile.TemporaryDirectory() as folder:
        write_map(folder + "/map")
        subprocess.run([bin_folder + "/orchard", "edit", "apply", folder + "/map", "--out", folder + "/whole"], check=True,
                       stdout=subprocess.DEVNULL)
        trees = trees_of(folder + "/whole")
        with browser.Browser() as page:
            requests = check_page(page, f"file://{folder}/whole/map.html", trees, pictures)
            assert all(each.startswith(f"file://{folder}/whole/map_tiles/") for each in requests), requests
            print(f"ok: from a disk, {len(requests)} tiles loaded")
            os.rename(folder + "/whole/map_tiles", folder + "/elsewhere")
            page.open(f"file://{folder}/whole/map.html")
            page.run("orchardApp.goTo(100, 100)")
            page.wait("return document.getElementById('found').textContent.includes('map_tiles')", "the missing folder")
        with Served(bin_folder, folder + "/whole") as served, browser.Browser() as page:
            requests = check_page(page, served.url, trees, pictures)
            assert all(each.startswith(served.url) for each in requests), requests
            print(f"ok: from a server, {len(requests)} requests")
            assert served.ask("/api/tile?name=../../etc/passwd")[0] == 404
            check_packing(served)
            check_correction(page, bin_folder, folder + "/whole", trees[5000])
            print("ok: a correction")


if __name__ == "__main__":
    main()

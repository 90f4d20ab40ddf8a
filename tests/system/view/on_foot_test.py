#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""on_foot_test.py BIN: map.html by keyboard, with a position, with a ruler, with tasks, on a telephone and on paper; and
what a served page shows when its server dies. Places come from map.csv and from GDAL's latitude and longitude."""
import csv
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import tempfile

import browser
import served


def orchard(bin_folder, *words):
    subprocess.run([os.path.join(bin_folder, "orchard"), *words], check=True, stdout=subprocess.DEVNULL)


def found(page):
    return page.run("return document.getElementById('found').textContent")


def spot_of(page, tree):
    return page.run("""const [x, y] = arguments, app = orchardApp; app.paintNow();
        return [app.view.toScreenX(x), app.view.toScreenY(y)];""", float(tree["x_m"]), float(tree["y_m"]))


def enter_selects_the_tree_in_the_middle(page, trees):
    tree = trees[len(trees) // 2]
    page.run("orchardApp.select(-1); orchardApp.view.x = arguments[0]; orchardApp.view.y = arguments[1];",
             float(tree["x_m"]) + 0.2, float(tree["y_m"]))
    page.run("document.getElementById('map').focus()")
    page.press("\ue007")  # Enter
    assert page.run("return orchardApp.selectedId") == int(tree["id"]), tree
    assert page.run("return document.getElementById('details').contains(document.activeElement)")
    page.press("\ue00c")  # Escape leads back to the map, which shows that it has the focus
    assert page.run("return orchardApp.selectedId") is None
    ring = page.run("const map = document.getElementById('map'), style = getComputedStyle(map);"
                    "return [document.activeElement === map, style.outlineStyle, style.outlineWidth]")
    assert ring == [True, "solid", "3px"], ring
    unnamed = page.run("return [...document.querySelectorAll('#tools button, #head button')]"
                       ".filter(b => !b.getAttribute('aria-label') && !b.closest('#rows')).map(b => b.id)")
    assert unnamed == [], unnamed


def the_position_leads_to_the_next_tree(page, tree, place):
    page.run("""const [latitude, longitude] = arguments;
        Object.defineProperty(navigator, 'geolocation', {value: {watchPosition: (took) => {
          took({coords: {latitude, longitude, accuracy: 3}}); return 1; }, clearWatch() {}}});
        orchardApp.select(-1);""", place[0] + 0.5 / 111132.0, place[1])  # half a metre north of it
    page.run("document.getElementById('here').click()")
    x, y = page.run("return orchardApp.here.place")
    off = math.hypot(x - float(tree["x_m"]), y - float(tree["y_m"]))
    assert abs(off - 0.5) < 0.03, (x, y, tree)
    words = f"Row {tree['row']}, tree {tree['position']}: 0.5 m to the south (position known to 3 m)."
    assert found(page) == words, (found(page), words)


def the_ruler_measures(page, first, second):
    page.run("orchardApp.here.place = null; orchardApp.select(-1); orchardApp.fit(); orchardApp.paintNow();"
             "document.getElementById('ruler').click()")
    for tree in (first, second):
        page.click(*spot_of(page, tree))
    length = math.hypot(float(first["x_m"]) - float(second["x_m"]), float(first["y_m"]) - float(second["y_m"]))
    pixel = 1 / page.run("return orchardApp.view.scale")
    assert abs(float(found(page).split(" ")[0]) - length) < 2 * pixel, (found(page), length)
    page.run("document.getElementById('ruler').click()")
    page.click(*spot_of(page, first))
    assert page.run("return orchardApp.selectedId") == int(first["id"])


def tasks_are_ticked_and_come_back(page, bin_folder, folder, mapped):
    tasks = folder + "/tasks.geojson"
    orchard(bin_folder, "tasks", mapped, "--out", tasks)
    page.run("document.getElementById('tasks-box').open = true")
    page.choose_file("#tasks-file", tasks)
    num = page.wait("return document.querySelectorAll('#tasks li').length", "the tasks")
    with open(tasks, encoding="utf-8") as file:
        first = json.load(file)["features"]
    assert num == len(first) > 0, num
    page.run("document.querySelector('#tasks li button').click()")
    place = page.run("return [orchardApp.tasks.list[0].place, orchardApp.model.rows.flatMap((row) => row.gaps)]")
    assert min(math.hypot(gap[1] - place[0][0], gap[2] - place[0][1]) for gap in place[1]) < 0.02, place
    page.run("document.querySelector('#tasks li input').click()")
    assert page.run("return document.getElementById('tasks-words').textContent") == f"{num - 1} of {num} open; not saved"
    page.run("document.getElementById('tasks-save').click()")
    orchard(bin_folder, "tasks", mapped, "--ticked", page.downloaded("tasks.geojson"), "--out", tasks, "--overwrite")
    with open(tasks, encoding="utf-8") as file:
        again = json.load(file)["features"]
    assert [f["properties"]["state"] for f in again] == ["done"] + ["open"] * (num - 1), again
    assert [f["geometry"] for f in again] == [f["geometry"] for f in first]
    bad = folder + "/bad.geojson"
    with open(bad, "w", encoding="utf-8") as file:
        file.write('{"features": [{"properties": {"state": "<b>"}, "geometry": {"coordinates": [1]}}]}')
    page.choose_file("#tasks-file", bad)
    page.wait("return document.getElementById('found').textContent.startsWith('bad.geojson is not a file of tasks')", "the refusal")


def half_of_a_telephone_shows_the_map(url, tree):
    with browser.Browser(390, 844) as page:
        page.open(url)
        page.run("orchardApp.select(orchardApp.model.withId(arguments[0]), true)", int(tree["id"]))
        share = page.run("""let seen = 0, all = 0;
            for (let x = 5; x < innerWidth; x += 10) for (let y = 5; y < innerHeight; y += 10) {
              ++all; seen += document.elementFromPoint(x, y).id === 'map'; }
            return seen / all;""")
        assert share >= 0.5, share


def paper_has_map_and_legend(map_html, folder):
    if not shutil.which("pdftotext"):
        return
    pdf = os.path.join(folder, "page.pdf")
    subprocess.run(["chromium", "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                    "--user-data-dir=" + folder + "/profile", "--no-pdf-header-footer", "--print-to-pdf=" + pdf,
                    "file://" + map_html], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    text = subprocess.run(["pdftotext", pdf, "-"], capture_output=True, text=True, check=True).stdout
    assert "Trees" in text and "The robot's path" in text and "trees in rows" in text.replace("\u00a0", " "), text
    assert "Warnings" not in text and "Rows whose" not in text, text


def a_dead_server_is_said(bin_folder, folder):
    with browser.Browser() as page:
        server = served.Served(bin_folder, folder)
        page.open(server.url)
        page.wait("return !document.body.classList.contains('stale')", "the page is connected")
        assert page.run("return document.getElementById('gone').hidden")
        server.process.send_signal(signal.SIGKILL)
        server.process.wait(30)
        page.wait("return !document.getElementById('gone').hidden", "the page says that its server is gone")
        assert "grayscale" in page.run("return getComputedStyle(document.getElementById('map')).filter")


def main():
    browser.require_chromium()
    bin_folder = sys.argv[1]
    with tempfile.TemporaryDirectory(prefix="orchard_on_foot_") as folder:
        log, mapped = folder + "/drive.lcm", folder + "/map"
        orchard(bin_folder, "simulate", "--scene", "orchard", "--seed", "4", "--duration", "40", "--out", log)
        orchard(bin_folder, "map", log, "--out", mapped, "--quiet", "--no-derived")
        orchard(bin_folder, "export", mapped, "--format", "csv", "--out", folder + "/places.csv")
        with open(mapped + "/map.csv") as file:
            trees = [row for row in csv.DictReader(file) if row["class"] == "tree" and row["position"]]
        with open(folder + "/places.csv") as file:
            places = {row["id"]: (float(row["latitude_deg"]), float(row["longitude_deg"])) for row in csv.DictReader(file)}
        assert len(trees) > 10
        url = "file://" + mapped + "/map.html"
        with browser.Browser() as page:
            page.open(url)
            enter_selects_the_tree_in_the_middle(page, trees)
            the_position_leads_to_the_next_tree(page, trees[3], places[trees[3]["id"]])
            the_ruler_measures(page, trees[0], trees[-1])
            tasks_are_ticked_and_come_back(page, bin_folder, folder, mapped)
            assert page.errors() == [], page.errors()
        half_of_a_telephone_shows_the_map(url, trees[0])
        paper_has_map_and_legend(mapped + "/map.html", folder)
        a_dead_server_is_said(bin_folder, mapped)
    print("the page holds on foot")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""watched_orchard.py [PICTURES]: an orchard of 300 trees watched while it is driven, in Chromium at 1280 and at 390 pixels.

`orchard live --edit` drives 6 rows of 50 places by simulation; on both pages trees are clicked and searched for by number, and one
of them is deleted, undone and deleted again. Then the recording with the slider, and map.html from the disk. Prints what was seen
and how soon; leaves pictures of the screen in PICTURES (out/watched). Needs a build in build/ (or BUILD=folder); six minutes.
"""
import csv
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, ROOT + "/tests/system/view")
import browser  # noqa: E402

BIN = os.environ.get("BUILD", ROOT + "/build") + "/bin/"
SIZES = ((1280, 800), (390, 844))
NUM_ROWS, NUM_PLACES = 6, 50
FIRST_PAINT = """
const paint = performance.getEntriesByName('first-contentful-paint')[0];
return paint ? paint.startTime : null;"""


def write_rig(path):
    with open(ROOT + "/config/orchard.yaml", encoding="utf-8") as file:
        text = file.read()
    for old, new in (("    num_rows: 4\n", f"    num_rows: {NUM_ROWS}\n    speed_mps: 2.0\n    missing_fraction: 0.0\n"),
                     ("    trees_per_row: 15\n", f"    trees_per_row: {NUM_PLACES}\n")):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def rows_of(path):
    with open(path, encoding="ascii") as file:
        return list(csv.DictReader(file))


def say(width, words):
    print(f"{width} pixels: {words}", flush=True)


def first_picture_ms(page):
    page.wait(FIRST_PAINT, "the first picture")
    return f"{page.wait(FIRST_PAINT, 'a picture'):.0f} ms"


def fits(page):
    outside = page.run("""return [...document.querySelectorAll('.card:not([hidden])')].filter((card) => {
        const box = card.getBoundingClientRect();
        return box.left < 0 || box.right > innerWidth || box.top < 0 || box.bottom > innerHeight + 1; }).map((card) => card.id)""")
    assert outside == [] and page.run("return document.documentElement.scrollWidth <= innerWidth"), outside


def click_trees(page, number):
    """Clicks `number` trees where the page draws them; each click selects the one that is there."""
    ids = page.run("""const c = orchardApp.model.columns, n = arguments[0];
        const trees = c.id.filter((id, i) => c.label[i] === 0);
        return trees.filter((id, k) => k % Math.ceil(trees.length / n) === 0);""", number)
    for tree in ids:
        place = page.run("""const app = orchardApp, i = app.model.withId(arguments[0]); app.select(-1); app.live && (app.live.isMoved = true);
            if (i < 0) return null;
            const c = app.model.columns; app.goTo(c.x[i], c.y[i]); app.paintNow();
            return [app.view.toScreenX(c.x[i]), app.view.toScreenY(c.y[i])];""", tree)
        if place is None:
            continue  # the map grows on
        page.click(*place)
        assert page.run("return orchardApp.selectedId") == tree, tree
        assert "cm" in page.run("return document.getElementById('details').innerText")
    page.run("orchardApp.select(-1)")
    return len(ids)


def search_trees(page, wanted):
    """Each by typing its row and number."""
    for row, position in wanted:
        page.run("orchardApp.select(-1)")
        page.type_into("#query", f"row {row} tree {position}\n")
        at = page.run("return orchardApp.model.at(...arguments)", row, position)
        found = page.run("return orchardApp.selectedId")
        assert found is not None and page.run("return orchardApp.model.withId(arguments[0])", found) == at, (row, position)


def edit_trees(page, other):
    """A tree is deleted here and gone there; undone there, back here; and again."""
    tree = page.run("const c = orchardApp.model.columns; return c.id[c.id.findIndex((id, i) => c.label[i] === 0)]")
    is_there = f"return orchardApp.model.withId({tree}) >= 0"
    page.run("orchardApp.select(orchardApp.model.withId(arguments[0]), true)", tree)
    page.run("document.getElementById('edit-delete').click()")
    for one in (page, other):
        one.wait(is_there.replace(">=", "<"), "the deletion")
    other.wait("return !document.getElementById('undo').disabled", "what there is to undo")
    other.run("document.getElementById('undo').click()")
    for one in (page, other):
        one.wait(is_there, "the undo")
    page.wait("return !document.getElementById('redo').disabled", "what there is to redo")
    page.run("document.getElementById('redo').click()")
    for one in (page, other):
        one.wait(is_there.replace(">=", "<"), "the redo")


def start_live(folder):
    live = subprocess.Popen([BIN + "orchard", "live", "rig.yaml", "--sim", "orchard", "--seed", "7", "--edit", "--out", "map",
                             "--record", "rec"], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, cwd=folder)
    for line in live.stderr:
        if found := re.search(r"watch it at (http://127.0.0.1:\d+/)", line):
            # What it says later is read, too, or it would wait for who reads.
            threading.Thread(target=live.stderr.read, daemon=True).start()
            return live, found.group(1)
    raise AssertionError("orchard live did not begin")


def watch(pages, url, pictures):
    for width, page in pages.items():
        page.open(url)
        page.wait("return orchardApp.live.pose !== null && orchardApp.live.scan.length > 20", "robot and scan", 60)
        page.wait("return !document.getElementById('look').hidden", "the camera's picture", 60)
        say(width, f"live: first picture {first_picture_ms(page)} after the page was asked for")
    wide, narrow = pages.values()
    wide.wait("return orchardApp.model.rows.length >= 3", "three rows", 300)
    for width, page in pages.items():
        num = page.run("return orchardApp.model.numberOf(0)")
        page.picture(f"{pictures}/live_{width}.png")
        say(width, f"live: {click_trees(page, 10)} of {num} trees clicked as the map grows")
        page.picture(f"{pictures}/live_tree_{width}.png")
        fits(page)
    edit_trees(wide, narrow)
    edit_trees(narrow, wide)
    print("live: deleted, undone and deleted again, from each page; each shows what the other does", flush=True)
    for width, page in pages.items():
        page.wait(f"return orchardApp.model.rows.length === {NUM_ROWS}", "all rows", 400)
        page.wait(f"return orchardApp.model.at({NUM_ROWS}, {NUM_PLACES - 5}) >= 0", "the last row's numbers", 400)
        wanted = page.run("""const { model } = orchardApp, numbers = [];
            for (let row = 1; row <= arguments[0]; ++row) {
              const places = [...Array(arguments[1]).keys()].map((k) => k + 1).filter((k) => model.at(row, k) >= 0);
              for (const share of [0.06, 0.28, 0.74]) numbers.push([row, places[Math.floor(share * places.length)]]);
            }
            return numbers;""", NUM_ROWS, NUM_PLACES)
        search_trees(page, wanted)
        page.picture(f"{pictures}/live_found_{width}.png")
        say(width, f"live: {len(wanted)} of {len(wanted)} numbers found")
        page.run("orchardApp.select(-1); orchardApp.fit()")
    for width, page in pages.items():
        page.picture(f"{pictures}/live_end_{width}.png")
        assert page.errors() == [], page.errors()
        others = [address for address in page.requests() if not address.startswith(url)]
        assert others == [], others


def slide(page, width, folder, pictures):
    recording = os.path.join("rec", sorted(os.listdir(os.path.join(folder, "rec")))[0])
    served = subprocess.Popen([BIN + "orchard", "view", recording], stdout=subprocess.PIPE, text=True, cwd=folder)
    try:
        url = re.search(r"http://127.0.0.1:\d+/", served.stdout.readline()).group(0)
        page.open(url)
        page.wait("return orchardApp.drive.numSteps > 10", "steps", 60)
        say(width, f"recorded: first picture {first_picture_ms(page)} after the page was asked for")
        page.wait("return orchardApp.drive.isDone", "the mapped log", 600)
        num = page.run("return orchardApp.drive.numSteps")
        counts = []
        for k in range(21):
            page.run("""const s = document.getElementById('slider'); s.value = Math.round(arguments[0] * (s.max - 0));
                s.dispatchEvent(new Event('input'))""", k / 20)
            counts.append(page.run("return orchardApp.model.numberOf(0)"))
        truth = rows_of(folder + "/replayed/map.csv")
        assert page.run("return orchardApp.model.count") == len(truth), (counts, len(truth))
        assert page.run("return orchardApp.model.numberOf(0)") == sum(row["class"] == "tree" for row in truth)
        page.run("orchardApp.drive.show(arguments[0])", num // 2)
        page.wait("return orchardApp.drive.pointsStep === orchardApp.drive.step && orchardApp.drive.points.length > 10", "the scan")
        page.wait("return !document.getElementById('look').hidden", "the picture")
        half = page.run("return orchardApp.model.numberOf(0)")
        assert half == counts[10] or abs(half - counts[10]) <= 2, (half, counts)
        page.picture(f"{pictures}/recorded_{width}.png")
        fits(page)
        say(width, f"recorded: {num} scans; trees as the slider goes through: {counts}")
        assert page.errors() == [], page.errors()
        assert [u for u in page.requests() if not u.startswith(url)] == []
    finally:
        served.send_signal(signal.SIGINT)
        assert served.wait(60) == 0


def from_disk(page, width, folder, pictures):
    url = f"file://{folder}/map/map.html"
    page.open(url)
    page.wait("return orchardApp.model.count > 0", "the map")
    say(width, f"map.html: first picture {first_picture_ms(page)} after the page was asked for")
    click_trees(page, 10)
    truth = rows_of(folder + "/map/map.csv")
    assert page.run("return orchardApp.model.count") == len(truth)
    numbered = [(int(row["row"]), int(row["position"])) for row in truth if row["class"] == "tree" and row["row"]]
    search_trees(page, numbered[:: len(numbered) // 20])
    page.picture(f"{pictures}/page_tree_{width}.png")
    page.run("orchardApp.select(-1); orchardApp.fit()")
    page.run("return 0")
    page.picture(f"{pictures}/page_{width}.png")
    fits(page)
    assert page.errors() == [] and page.requests() == [url]


def main():
    if len(sys.argv) > 1 and sys.argv[1] in ("-h", "--help"):
        print(__doc__)
        return
    pictures = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else ROOT + "/out/watched")
    os.makedirs(pictures, exist_ok=True)
    browser.require_chromium()
    if os.environ.get("IN_NAMESPACE") is None:  # what asks another host cannot hide, and nobody else's LCM is heard
        os.environ["IN_NAMESPACE"] = "yes"
        os.execv(ROOT + "/tests/system/in_namespace.sh", ["in_namespace.sh", sys.executable, "-B", os.path.abspath(__file__), pictures])
    with tempfile.TemporaryDirectory() as folder:
        write_rig(folder + "/rig.yaml")
        with browser.Browser(*SIZES[0]) as wide, browser.Browser(*SIZES[1]) as narrow:
            pages = {SIZES[0][0]: wide, SIZES[1][0]: narrow}
            live, url = start_live(folder)
            try:
                watch(pages, url, pictures)
                for page in pages.values():
                    page.open("about:blank")
                    page.requests()  # those of the live page until it was left are not map.html's
            finally:
                live.send_signal(signal.SIGINT)
                assert live.wait(90) == 0
            subprocess.run([BIN + "orchard", "map", "rec/" + sorted(os.listdir(folder + "/rec"))[0], "--config", "rig.yaml", "--out",
                            "replayed", "--quiet"], check=True, cwd=folder)
            with open(folder + "/map/map.csv", "rb") as a, open(folder + "/replayed/map.csv", "rb") as b:
                assert a.read() == b.read(), "the map of a watched drive is not that of its recording"
            trees = [row for row in rows_of(folder + "/map/map.csv") if row["class"] == "tree"]
            print(f"the map, {len(trees)} trees of {NUM_ROWS * NUM_PLACES}, is that of the recording", flush=True)
            for width, page in pages.items():
                from_disk(page, width, folder, pictures)
                slide(page, width, folder, pictures)
        with open(folder + "/map/corrections.jsonl", encoding="utf-8") as file:
            kinds = [json.loads(line)["what"] for line in file]
        print(f"corrections kept: {len(kinds)}")


if __name__ == "__main__":
    main()

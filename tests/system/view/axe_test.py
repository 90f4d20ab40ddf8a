#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""axe_test.py BIN RIG WORK: axe-core, which npm fetches into WORK, finds nothing serious on any page: map.html, report.html
with a comparison, a map that is edited, a log, a drive while it goes; wide and narrow, light and dark, with all open that
opens. Prints what it finds; skipped (77) where npm cannot be reached."""

import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile

sys.path[:0] = [os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "bags")]
import browser  # noqa: E402
import npm_modules  # noqa: E402
from served import Served  # noqa: E402

SERIOUS = ("serious", "critical")
CHECK = """const done = arguments[0];
    axe.run(document, {resultTypes: ['violations']}).then((found) => done(found.violations.map((rule) =>
        [rule.impact, rule.id, rule.help, rule.nodes.map((node) => node.target.join(' ') + ': ' + node.failureSummary)])),
        (error) => done([['critical', 'axe', String(error), []]]));"""
OPEN_ALL = """document.querySelectorAll('details').forEach((box) => { box.open = true; });
    const button = document.getElementById('menu-button'), menu = document.getElementById('menu');
    if (button && menu.hidden) button.click();"""


class Findings:
    """What axe-core says of each page, in one browser."""

    def __init__(self, page, axe, shape):
        self.page, self.axe, self.shape, self.serious, self.num = page, axe, shape, [], 0

    def check(self, name):
        self.num += 1
        self.page.run(self.axe + "\n;window.axe = axe; return 0")
        for impact, rule, words, nodes in self.page.run_async(CHECK):
            print(f"{name}, {self.shape}: {impact}: {rule}: {words}\n    " + "\n    ".join(nodes[:4]))
            if impact in SERIOUS:
                self.serious.append((name, rule))

    def check_map(self, name):
        """A page with a map: as it opens; with its menu open; with a tree selected."""
        self.check(name)
        self.page.run(OPEN_ALL)
        self.check(name + ", menu")
        self.page.run("orchardApp.select(0, true)")
        self.page.wait("return !document.getElementById('details').hidden", "the details")
        self.check(name + ", tree")


def check_pages(found, bin_folder):
    page = found.page
    page.open("file://" + os.path.abspath("map/map.html"))
    page.wait("return window.orchardApp && orchardApp.model.count > 10", "the map")
    page.choose_file("#tasks-file", os.path.abspath("tasks.geojson"))
    page.wait("return document.querySelectorAll('#tasks li').length > 0", "the tasks")
    found.check_map("map.html")
    page.open("file://" + os.path.abspath("report/report.html"))
    found.check("report.html")
    with Served(bin_folder, "map", "--edit") as served:
        page.open(served.url)
        page.wait("return window.orchardApp && orchardApp.model.count > 10 && !document.getElementById('edit').hidden", "the map")
        found.check_map("edit")
        page.run("document.getElementById('edit-renumber').click()")
        found.check("edit, form")
        page.open("about:blank")
    with Served(bin_folder, "tubes.lcm") as served:
        page.open(served.url)
        page.wait("return window.orchardApp && orchardApp.drive.isDone", "the log", 120)
        page.run("orchardApp.drive.show(orchardApp.drive.numSteps >> 1)")
        page.wait("return document.getElementById('confidences').innerText.includes('tree')", "the picture's table")
        found.check_map("view LOG")
    page.wait("return !document.getElementById('gone').hidden", "that the server is gone")
    found.check("view LOG, server gone")


def check_live(found, bin_folder, rig):
    live = subprocess.Popen([bin_folder + "/orchard", "live", rig, "--sim", "tubes", "--seed", "5"], stderr=subprocess.PIPE,
                            stdout=subprocess.DEVNULL, text=True)
    try:
        url = next(match.group(0) for line in live.stderr if (match := re.search(r"http://127.0.0.1:\d+/", line)))
        for _ in range(100):  # until the viewer serves
            try:
                found.page.open(url)
                break
            except RuntimeError:
                pass
        found.page.wait("return window.orchardApp && orchardApp.model.count > 3", "the growing map", 90)
        found.page.wait("return document.getElementById('processes').innerText.includes('Hz')", "the processes")
        found.check_map("live")
    finally:
        live.send_signal(signal.SIGINT)
        live.stderr.read()
        live.wait(60)


def main():
    browser.require_chromium()
    bin_folder, rig, work = (os.path.abspath(word) for word in sys.argv[1:4])
    modules = npm_modules.fetch(pathlib.Path(work), ["axe-core@4"], ("node", "npm"))
    axe = (modules / "node_modules/axe-core/axe.min.js").read_text(encoding="utf-8")
    serious, num = [], 0
    with tempfile.TemporaryDirectory(prefix="orchard_axe_") as folder:
        os.chdir(folder)
        for words in ("simulate --scene tubes --seed 3 --out tubes.lcm",
                      "simulate --scene orchard --seed 2 --duration 40 --out first.lcm",
                      "simulate --scene orchard --seed 2 --duration 40 --out second.lcm",
                      "map first.lcm --out before --quiet --no-derived",
                      "map second.lcm --previous before --out map --quiet --no-derived",
                      "tasks map --out tasks.geojson",
                      "report map --previous before --out report"):
            subprocess.run([bin_folder + "/orchard", *words.split()], check=True, stdout=subprocess.DEVNULL)
        for width, height, dark in ((1280, 800, False), (1280, 800, True), (390, 844, False)):
            with browser.Browser(width, height, dark) as page:
                found = Findings(page, axe, f"{width} wide, {'dark' if dark else 'light'}")
                check_pages(found, bin_folder)
                check_live(found, bin_folder, rig)
                serious += found.serious
                num += found.num
    assert serious == [], f"serious findings: {sorted(set(serious))}"
    print(f"ok: nothing serious on {num} pages")


main()

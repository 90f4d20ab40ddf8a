#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""first_picture.py BIN: how soon `map.html` of 20,000, 52,000 and 100,000 trees shows its first picture and its trees from a
disk, beside four programs that keep the processors busy. The largest of five openings each, in Chromium without a graphics card.
BIN: the folder of the programs."""

import multiprocessing
import os
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "system"))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "system", "view"))
import browser  # noqa: E402
import maps  # noqa: E402

NUM_PLACES, ROW_M, TREE_M, NUM_BUSY = 400, 4.5, 2.5, 4


def keep_busy():
    while True:
        pass


def write_map(folder, num_rows):
    dice = random.Random(1)
    lines = (maps.landmark(row * NUM_PLACES + place + 1, TREE_M * place + dice.gauss(0, 0.1), ROW_M * row + dice.gauss(0, 0.1),
                           row + 1, place + 1) for row in range(num_rows) for place in range(NUM_PLACES))
    path = [(10.0 * step, ROW_M * row + 2.2, 0) for row in range(num_rows) for step in range(100)]
    maps.write_map(folder, lines, path, maps.datum(-27, 151))


def opened_s(url):
    """Seconds until the first paint, and until the canvas is drawn with what this view shows."""
    with browser.Browser() as page:
        page.open(url)
        page.wait("return window.orchardApp && !orchardApp.isDue", "the picture")
        return page.run("return [Math.max(...performance.getEntriesByType('paint').map((each) => each.startTime)) / 1000, "
                        "(performance.timing.domContentLoadedEventEnd - performance.timing.navigationStart) / 1000]")


def main():
    browser.require_chromium()
    for num_rows in (50, 130, 250):
        with tempfile.TemporaryDirectory() as folder:
            write_map(folder + "/map", num_rows)
            subprocess.run([sys.argv[1] + "/orchard", "edit", "apply", folder + "/map", "--out", folder + "/whole"], check=True,
                           stdout=subprocess.DEVNULL)
            busy = [multiprocessing.Process(target=keep_busy, daemon=True) for _ in range(NUM_BUSY)]
            for each in busy:
                each.start()
            times = [opened_s(f"file://{folder}/whole/map.html") for _ in range(5)]
            for each in busy:
                each.terminate()
            paints = [paint for paint, _ in times if paint]
            print(f"{num_rows * NUM_PLACES} trees: first paint at most {max(paints):.2f} s, first picture at most "
                  f"{max(drawn for _, drawn in times):.2f} s", flush=True)


main()

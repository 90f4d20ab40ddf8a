#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What does a million trees in one place cost: joined, published, asked for, reported, exported, shown?

100 blocks of 10,000 trees (4 m x 2 m, 8 % missing, planted to 10 cm), each mapped by two robots to
1 cm, of rows 1 to 60 and 41 to 100, the second in a frame of its own. The maps are written as such,
without drives. Then `orchard merge --any-place` joins each block, `orchard publish` puts all into one
database (PostgreSQL with PostGIS of its own), which is asked five things; and the map of one block
of all the trees is published, reported, exported in four formats and shown in a browser. For every step its time, processor time and peak
memory; the join is checked against the trees that were planted. Prints one table; needs a build in
build/ (or BUILD=folder).

usage: tests/experiments/million_trees.py [BLOCKS [TREES [JOINED]]]     (default 100 10000 100)
  JOINED: blocks that are joined of two robots' maps; the others are published as one robot's map
  0 TREES: the one map of all trees alone
  dates TREES: a block at two dates, one tree in fifty gone, as many new and half as many moved,
    the second map turned and shifted: compared and merged
"""
import csv
import math
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import urllib.request

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path[:0] = [ROOT + "/tests/system", ROOT + "/tests/system/publish"]
import maps  # noqa: E402
import server as postgres  # noqa: E402
sys.path.insert(0, ROOT + "/tests/system/view")
import browser  # noqa: E402

ORCHARD = os.environ.get("BUILD", ROOT + "/build") + "/bin/orchard"
ROW_M, TREE_M = 4.0, 2.0


class Cost:
    """Time, processor time and peak memory of several runs of one command."""

    def __init__(self):
        self.num, self.wall_s, self.cpu_s, self.worst_s, self.peak_mib = 0, 0.0, 0.0, 0.0, 0.0

    def run(self, *command):
        begin = time.monotonic()
        pid = os.posix_spawn(command[0], command, os.environ, file_actions=[
            (os.POSIX_SPAWN_OPEN, 1, "/dev/null", os.O_WRONLY, 0)])
        _, status, used = os.wait4(pid, 0)
        if status != 0:
            sys.exit("failed: " + " ".join(command))
        cpu_s = used.ru_utime + used.ru_stime
        self.num += 1
        self.wall_s += time.monotonic() - begin
        self.cpu_s += cpu_s
        self.worst_s = max(self.worst_s, cpu_s)
        self.peak_mib = max(self.peak_mib, used.ru_maxrss / 1024)

    def line(self, what):
        return (f"| {what} | {self.wall_s:.1f} s | {self.cpu_s:.1f} s, at most {self.worst_s:.1f} s of "
                f"{self.num} | {self.peak_mib:.0f} MiB |")


def plant(trees, dice):
    """Rows of (x, y) [m]; a place in twelve is empty."""
    num_rows = max(5, round(math.sqrt(trees / 1.087)))
    num_places = math.ceil(trees / 0.92 / num_rows)
    return [[(TREE_M * k + dice.gauss(0, 0.1), ROW_M * row + dice.gauss(0, 0.1))
             for k in range(num_places) if dice.random() < 0.92] for row in range(num_rows)]


def write_map(folder, rows, first, end, frame, dice, step_m=1.0, block=0):
    """A robot's map of rows [first, end), in a frame (x, y, yaw) of its own; returns its trees."""
    c, s = math.cos(frame[2]), math.sin(frame[2])

    def placed(x, y):
        return frame[0] + c * x - s * y, frame[1] + s * x + c * y

    lines = []
    for row in range(first, end):
        for k, (x, y) in enumerate(rows[row]):
            px, py = placed(x + dice.gauss(0, 0.01), y + dice.gauss(0, 0.01))
            lines.append(maps.landmark(len(lines) + 1, px, py, row - first + 1, k + 1, dice.gauss(0.12, 0.01), num=60))
    length_m = max(rows[first][-1][0], rows[end - 1][-1][0])
    path = []
    for aisle in range(first, end + 1):
        is_back = (aisle - first) % 2 == 1
        yaw = math.remainder(frame[2] + (math.pi if is_back else 0.0), 2 * math.pi)
        for i in range(int(length_m / step_m) + 1):
            path.append((*placed(length_m - step_m * i if is_back else step_m * i, ROW_M * (aisle - 0.5)), yaw))
    maps.write_map(folder, lines, path, maps.datum(41.6 + 0.005 * (block // 10), 0.6 + 0.005 * (block % 10), 200.0, yaw_rad=0.2))
    return len(lines)


def errors_of(folder, rows):
    """Trees of a map without a planted one within 5 cm, planted ones without one, and twice."""
    near, planted = {}, [p for row in rows for p in row]
    for i, (x, y) in enumerate(planted):
        near.setdefault((int(x // 1), int(y // 1)), []).append(i)
    seen, wrong, twice = set(), 0, 0
    with open(folder + "/map.csv") as file:
        for tree in csv.DictReader(file):
            x, y = float(tree["x_m"]), float(tree["y_m"])
            best, best_m = None, 0.05
            for i in (j for dx in (-1, 0, 1) for dy in (-1, 0, 1)
                      for j in near.get((int(x // 1) + dx, int(y // 1) + dy), [])):
                apart_m = math.dist((x, y), planted[i])
                if apart_m < best_m:
                    best, best_m = i, apart_m
            wrong += best is None
            twice += best in seen
            seen.add(best)
    return wrong, len(planted) - len(seen - {None}), twice


def ask(db, what, sql):
    begin = time.monotonic()
    answer = db.sql(sql)
    print(f"| {what} | {1000 * (time.monotonic() - begin):.0f} ms | | {answer[0] if answer else ''} |",
          flush=True)


def memory_mib(pid):
    """Of a process and its children, pages in common counted once."""
    kib = 0
    try:
        with open(f"/proc/{pid}/smaps_rollup") as file:
            kib = sum(int(line.split()[1]) for line in file if line.startswith("Pss:"))
        with open(f"/proc/{pid}/task/{pid}/children") as file:
            return kib / 1024 + sum(memory_mib(int(child)) for child in file.read().split())
    except OSError:
        return kib / 1024


def show(folder):
    """Serves a map's page and shows it in a browser: the overview, then ten places near."""
    begin = time.monotonic()
    server = subprocess.Popen([ORCHARD, "view", folder, "--listen", "127.0.0.1:8497"],
                              stdout=subprocess.PIPE, text=True)
    url = re.search(r"http://\S+?/", server.stdout.readline()).group(0)
    ready_s = time.monotonic() - begin
    with urllib.request.urlopen(url) as answer:
        num_bytes = len(answer.read())
    loads_s, most_mib = [], 0.0
    with browser.Browser(1280, 900) as page:
        page.open(url)
        page.wait("return orchardApp.tiles.shown !== null", "the overview")
        drawn_s = page.run("return performance.now()") / 1000
        for k in range(10):
            begin = time.monotonic()
            page.run("orchardApp.goTo(...arguments); orchardApp.view.scale = 6; orchardApp.paintNow()",
                     180 * k, 350 * k)
            page.wait("return orchardApp.tiles.pending.size === 0 && orchardApp.tiles.shown.length > 0", "the tiles in view")
            loads_s.append(time.monotonic() - begin)
            most_mib = max(most_mib, memory_mib(page.driver.pid))
    server.send_signal(signal.SIGINT)
    _, _, used = os.wait4(server.pid, 0)
    print(f"| page of all trees: server ready | {ready_s:.1f} s | {used.ru_utime + used.ru_stime:.1f} s | "
          f"{used.ru_maxrss / 1024:.0f} MiB |\n| the same: overview drawn ({num_bytes / 1e6:.1f} MB); tiles of a "
          f"view | {drawn_s:.1f} s; {sorted(loads_s)[5]:.1f} s, at most {max(loads_s):.1f} s | | browser: "
          f"{most_mib:.0f} MiB |", flush=True)


def step(what, *command):
    cost = Cost()
    cost.run(ORCHARD, *command)
    print(cost.line(what), flush=True)


def two_dates(trees, work):
    dice = random.Random(7)
    rows, later = plant(trees, dice), []
    for row in rows:
        later.append([])
        for x, y in row:
            fate = dice.random()
            if fate < 0.02:
                continue
            later[-1].append((x + 0.4 if fate < 0.03 else x, y))
            if fate > 0.98:
                later[-1].append((x + 1.0, y + 0.1))
    write_map(work + "/a", rows, 0, len(rows), (0.0, 0.0, 0.0), dice)
    write_map(work + "/b", later, 0, len(rows), (1.2, -0.8, 0.001), dice)
    print("| step | passed | processor | most memory |\n|---|---|---|---|")
    step("compared", "compare", work + "/a", work + "/b", "--out", work + "/changes")
    step("compared without pictures", "compare", work + "/a", work + "/b", "--json")
    step("merged", "merge", work + "/a", work + "/b", "--out", work + "/both")


def whole(db, trees, work):
    """One map of all trees: published, reported, exported, shown."""
    dice = random.Random(0)
    rows = plant(trees, dice)
    os.makedirs(work)
    num = write_map(work + "/one", rows, 0, len(rows), (0.0, 0.0, 0.0), dice, step_m=5.0)
    print(f"one map of {num} trees:\n| step | passed | processor | most memory |\n|---|---|---|---|")

    step("published as one block", "publish", work + "/one", "--to", db.url(), "--block", "all", "--date", "2026-04-10")
    step("reported", "report", work + "/one", "--out", work + "/report")
    for suffix, form in (("csv", "csv"), ("geojson", "geojson"), ("gpkg", "gpkg"), ("fgb", "flatgeobuf")):
        step("exported as " + form, "export", work + "/one", "--format", form, "--out", f"{work}/trees.{suffix}")
        os.remove(f"{work}/trees.{suffix}")
    show(work + "/one")


def main():
    if len(sys.argv) > 1 and sys.argv[1] in ("-h", "--help"):
        print(__doc__)
        return
    if sys.argv[1:2] == ["dates"]:
        with tempfile.TemporaryDirectory() as work:
            return two_dates(int(sys.argv[2]), work)
    blocks = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    trees = int(sys.argv[2]) if len(sys.argv) > 2 else 10000
    joined = int(sys.argv[3]) if len(sys.argv) > 3 else blocks
    merge, publish = Cost(), Cost()
    num, wrong, missing, twice = 0, 0, 0, 0
    with postgres.Server() as db, tempfile.TemporaryDirectory() as work:
        for block in range(1, blocks + 1):
            dice = random.Random(block)
            rows = plant(trees, dice)
            num += sum(map(len, rows))
            at = f"{work}/{block}"
            os.makedirs(at)
            is_joined = block <= joined
            write_map(at + "/a", rows, 0, 6 * len(rows) // 10 if is_joined else len(rows),
                      (0.0, 0.0, 0.0), dice, block=block)
            if is_joined:
                write_map(at + "/b", rows, 4 * len(rows) // 10, len(rows),
                          (dice.uniform(-300, 300), dice.uniform(-300, 300), dice.uniform(-3.1, 3.1)),
                          dice, block=block)
                merge.run(ORCHARD, "merge", at + "/a", at + "/b", "--any-place", "--out", at + "/both")
                one = errors_of(at + "/both", rows)
                wrong, missing, twice = wrong + one[0], missing + one[1], twice + one[2]
            publish.run(ORCHARD, "publish", at + ("/both" if is_joined else "/a"), "--to", db.url(),
                        "--block", f"block_{block}", "--date", "2026-04-10")
            if block > 1:
                shutil.rmtree(at)
        if blocks == 0:
            return whole(db, trees, work + "/all")
        print(f"{num} trees planted in {blocks} blocks; of {joined} that were joined {wrong} trees wrong, "
              f"{missing} not found, {twice} twice")
        print("| step | passed | processor | most memory, or answer |\n|---|---|---|---|")
        print(merge.line("join of a block's two robots, page and files included"))
        print(publish.line("publish a block"), flush=True)
        ask(db, "trees of all blocks", "SELECT count(*) FROM orchard.tree")
        ask(db, "per block", "SELECT block, count(*) FROM orchard.tree GROUP BY block ORDER BY block")
        ask(db, "in a rectangle of 20 m", "SELECT count(*) FROM orchard.tree t, (SELECT place FROM "
            "orchard.tree WHERE block = 'block_1' LIMIT 1) c WHERE t.place && ST_Expand(c.place, 1e-4)")
        ask(db, "ten nearest", "SELECT count(*) FROM (SELECT 1 FROM orchard.tree t ORDER BY t.place <-> "
            "(SELECT place FROM orchard.tree WHERE block = 'block_1' LIMIT 1) LIMIT 10) n")
        ask(db, "widest ten of one block", "SELECT count(*) FROM (SELECT width_m FROM orchard.tree "
            "WHERE block = 'block_1' ORDER BY width_m DESC LIMIT 10) w")
        page = work + "/1/both/map.html"
        print(f"page of one block: {os.path.getsize(page) / 1e6:.1f} MB")
        whole(db, max(1, blocks) * trees, work + "/all")


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: BSD-3-Clause
"""Measurements of killed processes: at random under a supervisor, and while the map is saved."""
import itertools
import json
import os
import re
import shutil
import signal
import sqlite3
import sys
import time

import wire
from drive import Drive
from hosts import lone_host
from maps import Difference, rows
from programs import NODES, Program, Supervised, seeded
from table import Row

FEEDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "feeder.py")
# what shows that a process works again
OUTPUT = {"detector": "DETECTIONS", "pose": "POSE", "mapper": "STATUS", "driver": "SCAN"}


def feeder(bench, host, log, begin, speed, channels):
    words = [sys.executable, "-B", FEEDER, log, begin, speed, ",".join(channels)]
    program = Program(host, words, os.path.join(bench.work, "feeder.log"))
    bench.running.append(program)
    return program


def wait_for_nodes(listener, seconds=20):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if all(listener.statuses("orchard-" + name) for name in NODES):
            return
        time.sleep(0.05)
    raise RuntimeError("the nodes do not appear on STATUS")


def committed(path):
    """Trees that a saved map tells by id, {} without one."""
    if not os.path.exists(path):
        return {}
    return {row["id"]: row for row in rows(path) if row["class"] == "tree"}


def still_there(before, after):
    """How many of these trees have their id, and how many stand somewhere in the map."""
    same = sum(1 for i, row in before.items()
               if i in after and abs(after[i]["x"] - row["x"]) + abs(after[i]["y"] - row["y"]) < 0.3)
    places = [(row["x"], row["y"]) for row in after.values()]
    there = sum(1 for row in before.values()
                if any(abs(x - row["x"]) + abs(y - row["y"]) < 0.3 for x, y in places))
    return same, there


def kills(bench, arguments):
    """kill -9 of every process at random under a supervisor: how soon back, what is lost."""
    drive = Drive(bench, "config/orchard.yaml", arguments.seed)
    num = arguments.num or (6 if arguments.short else 100)
    random = seeded(arguments.seed)
    out = os.path.join(bench.work, "map")
    shutil.rmtree(out, ignore_errors=True)
    map_path = os.path.join(out, "map.csv")
    host = lone_host()
    listener = wire.Listener(host, keep=("STATUS", "DETECTIONS", "POSE", "SCAN"))
    url = bench.url.replace("ttl=1", "ttl=0")
    begin = time.monotonic() + 3.0
    starts = {name: (lambda name=name: bench.start(host, name, "--config", drive.config,
                                                   *(("--out", out) if name == "mapper" else ()),
                                                   url=url)) for name in NODES}
    starts["driver"] = lambda: feeder(bench, host, drive.log, begin, 1.0, wire.SOURCES)
    kept = {name: Supervised(start) for name, start in starts.items()}
    wait_for_nodes(listener)
    time.sleep(max(0.0, begin + 8.0 - time.monotonic()))
    pause = 100.0 / num if not arguments.short else 1.5
    killed, before_kill = [], {}
    for _ in range(num):
        name = random.choice(sorted(kept))
        if name == "mapper":
            before_kill = {**before_kill, **committed(map_path)}
        killed.append((time.monotonic(), name))
        kept[name].kill()
        time.sleep(random.uniform(0.6, 1.4) * pause)
    time.sleep(3.0)
    kept["driver"].stop(signal.SIGKILL)
    codes = {name: kept[name].stop() for name in NODES}
    listener.close()
    host.close()
    back = {name: [] for name in kept}
    for moment, name in killed:
        back[name].append(first_output(listener, name, moment) - moment)
    after = committed(map_path)
    same, there = still_there(before_kill, after)
    found = []
    for name in sorted(back):
        times = [t for t in back[name]]
        if times:
            most = max(times)
            found.append(Row("kills", f"{name}: killed {len(times)} times; works again after, at most",
                             "not always" if most == float("inf") else f"{most:.2f} s", "1 s",
                             most <= 1.0))
    difference = Difference(drive.map, map_path)
    found.append(Row("kills", "trees saved before a kill of the mapper that are in the last map; with their id",
                     f"{there}, {same} of {len(before_kill)}", "all, all",
                     same == there == len(before_kill) > 0))
    found.append(Row("kills", f"map after {num} kills against the map without", str(difference),
                     "(what was measured meanwhile is missing)", None))
    found.append(Row("kills", "exit codes at the end", ", ".join(f"{n} {c}" for n, c in codes.items()), "0",
                     set(codes.values()) == {0}))
    return found


def first_output(listener, name, moment):
    """When a killed process was first heard again."""
    if name == "mapper":
        return next((a for a, s in listener.statuses("orchard-mapper", moment + 0.02)), float("inf"))
    return next((a for a, channel, _ in listener.messages
                 if channel == OUTPUT[name] and a > moment + 0.02), float("inf"))


def opens(folder):
    """What is wrong with a saved map, "" for nothing."""
    path = os.path.join(folder, "map.csv")
    with open(path, "rb") as file:
        text = file.read()
    if not text.endswith(b"\n") or any(line.count(b",") != text.split(b"\n")[0].count(b",")
                                       for line in text.strip().split(b"\n")):
        return "map.csv is cut"
    geopackage = os.path.join(folder, "map.gpkg")
    if os.path.exists(geopackage):
        try:
            with sqlite3.connect(f"file:{geopackage}?mode=ro", uri=True) as base:
                if base.execute("PRAGMA integrity_check").fetchone()[0] != "ok":
                    return "map.gpkg is damaged"
        except sqlite3.DatabaseError as error:
            return f"map.gpkg: {error}"
    for name in ("summary.json", "graph.json"):
        path = os.path.join(folder, name)
        if os.path.exists(path):
            try:
                with open(path) as file:
                    json.load(file)
            except ValueError as error:
                return f"{name}: {error}"
    return ""


def kills_saving(bench, arguments):
    """kill -9 of the mapper while it saves: every map opens, and none is smaller than the last."""
    drive = Drive(bench, "config/orchard.yaml", arguments.seed)
    num = arguments.num or (10 if arguments.short else 200)
    random = seeded(arguments.seed)
    out = os.path.join(bench.work, "map")
    shutil.rmtree(out, ignore_errors=True)
    os.makedirs(out)
    path = os.path.join(out, "map.csv")
    host = lone_host()
    url = bench.url.replace("ttl=1", "ttl=0")
    derived = wire.read_log(os.path.join(drive.folder, "derived.lcm"))
    events = [(c, d) for _, c, d in derived if c in ("DETECTIONS", "POSE")]
    sender = wire.Sender(host, ttl=0)
    messages = endless(events)
    bad, num_in_save, most_trees, num_shrunk = [], 0, 0, 0
    for round_number in range(num):
        mapper = bench.start(host, "mapper", "--config", drive.config, "--out", out, url=url)
        begin, saving = time.monotonic(), False
        known = {name for name in os.listdir(out) if is_temporary(name)}
        next_send = begin + 0.3
        while time.monotonic() - begin < 12.0 and mapper.alive():
            now = time.monotonic()
            if now >= next_send:
                # some seconds of the drive in one: the map changes before every save
                for channel, data in itertools.islice(messages, 6):
                    sender.send(channel, data)
                next_send = now + 0.02
            saving = any(is_temporary(name) and name not in known for name in os.listdir(out))
            if saving:
                break
            time.sleep(0.0005)
        time.sleep(random.uniform(0.0, 0.08))
        mapper.kill()
        num_in_save += saving
        bench.running.remove(mapper)
        if os.path.exists(path):
            wrong = opens(out)
            if wrong:
                bad.append(f"round {round_number}: {wrong}")
            trees_now = len(committed(path))
            num_shrunk += trees_now < most_trees - 1
            most_trees = max(most_trees, trees_now)
        if sys.stderr.isatty() or round_number % 50 == 49:
            print(f"field: kills_saving {round_number + 1} of {num}", file=sys.stderr)
    left = [name for name in os.listdir(out) if is_temporary(name)]
    writers = {re.search(r"\.([0-9]+)-", name).group(1) for name in left}  # a start removes those of others
    host.close()
    return [
        Row("kills_saving", f"maps that open after {num} kills, {num_in_save} of them as a save began",
            f"{num - len(bad)}" + (f" ({bad[0]})" if bad else ""), f"{num}", not bad),
        Row("kills_saving", "maps smaller than an earlier one; temporary files left at the end",
            f"{num_shrunk}; {len(left)} of {len(writers)} processes", "0; at most those of the last kill",
            num_shrunk == 0 and len(writers) <= 1),
    ]


def is_temporary(name):
    """Whether a file in the map's folder is one that a save has begun."""
    return re.fullmatch(r"\..+\.[0-9]+-[0-9]+(\.[a-z]+)?", name) is not None


def endless(events):
    """What detector and pose sent, again and again, with times and numbers that go on."""
    first, last = wire.stamp(events[0][1])[0], wire.stamp(events[-1][1])[0]
    lap = 0
    while True:
        for number, (channel, data) in enumerate(events):
            shift = lap * (last - first + 1_000_000)
            kind = wire.types.detections_v2_t if channel == "DETECTIONS" else wire.types.pose_t
            message = kind.decode(data)
            message.utime += shift
            message.seq += lap * len(events)
            for trunk in getattr(message, "trunks", []):
                trunk.utime += shift
            yield channel, message.encode()
        lap += 1

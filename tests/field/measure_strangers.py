# SPDX-License-Identifier: BSD-3-Clause
"""Measurements of what should be there once and is there twice, and of old messages among new ones."""
import os
import re
import shutil
import time

import wire
from drive import Drive
from hosts import Network, lone_host
from maps import Difference
from measure_clocks import clipped, complaints, driven
from measure_kills import feeder, wait_for_nodes
from programs import NODES
from table import Row

TWICE = re.compile(r"second one|two sources|twice|also|already|runs beside")


def twice(bench, arguments):
    """A second detector, pose, mapper or driver appears on another host: who says so, how soon."""
    drive = Drive(bench, "config/orchard.yaml", arguments.seed)
    found = []
    for name in (*NODES, "driver"):
        with Network(["one", "two"]) as network:
            listener = wire.Listener(network["one"])
            out = os.path.join(bench.work, "map")
            for folder in (out, out + "2"):
                shutil.rmtree(folder, ignore_errors=True)
            bench.start_nodes(network["one"], drive.config, out)
            wait_for_nodes(listener)
            begin = time.monotonic() + 0.2
            feeder(bench, network["one"], drive.log, begin, 1.0, wire.SOURCES)
            time.sleep(3.0)
            moment = time.monotonic()
            if name == "driver":
                second = feeder(bench, network["two"], drive.log, begin - 20.0, 1.0, wire.SOURCES)
            else:
                second = bench.start(network["two"], name, "--config", drive.config,
                                     *(("--out", out + "2") if name == "mapper" else ()))
            told = listener.wait(lambda s: s.level >= 2 and TWICE.search(s.text), 6)
            ended = None if second.alive() else second.process.returncode
            listener.close()
            bench.close()
        words = f"{told[0] - moment:.1f} s: {told[1].name}: {told[1].text}" if told else "nobody says so"
        met = told is not None and told[0] - moment <= 2.0
        wanted = "named within 2 s"
        if name == "mapper":
            words += "; the second one " + ("runs on" if ended is None else f"ends with {ended}")
            met, wanted = met and ended not in (None, 0), wanted + ", refuses"
        found.append(Row("twice", f"a second {name}", clipped(words), wanted, met))
    return found


def same_folder(bench, arguments):
    """Two mappers that save into one folder of one machine."""
    drive = Drive(bench, "config/orchard.yaml", arguments.seed)
    host = lone_host()
    bench.url = bench.url.replace("ttl=1", "ttl=0")
    out = os.path.join(bench.work, "map")
    shutil.rmtree(out, ignore_errors=True)
    first = bench.start(host, "mapper", "--config", drive.config, "--out", out)
    time.sleep(1.0)
    second = bench.start(host, "mapper", "--config", drive.config, "--out", out)
    time.sleep(2.0)
    words = f"first {'runs on' if first.alive() else 'ended'}, second " + \
        ("runs on" if second.alive() else f"ends with {second.process.returncode}")
    met = first.alive() and not second.alive() and second.process.returncode != 0
    host.close()
    return [Row("same_folder", "two mappers, one --out", words, "the second refuses", met)]


def old_types(bench, arguments):
    """Every second DETECTIONS in the first release's form: the mapper reads both."""
    drive = Drive(bench, "config/orchard.yaml", arguments.seed, 20.0 if arguments.short else 0.0)
    host = lone_host()
    bench.url = bench.url.replace("ttl=1", "ttl=0")
    events = [(c, d) for _, c, d in wire.read_log(os.path.join(drive.folder, "derived.lcm"))
              if c in ("DETECTIONS", "POSE")]
    maps = {}
    for kind in ("new", "mixed"):
        out = os.path.join(bench.work, kind)
        shutil.rmtree(out, ignore_errors=True)
        mapper = bench.start(host, "mapper", "--config", drive.config, "--out", out)
        listener, sender = wire.Listener(host), wire.Sender(host, ttl=0)
        listener.wait(lambda s: s.name == "orchard-mapper", 10)
        for number, (channel, data) in enumerate(events):
            if kind == "mixed" and channel == "DETECTIONS" and wire.stamp(data)[1] % 2:
                data = first_form(data)
            sender.send(channel, data)
            if number % 20 == 19:
                time.sleep(0.01)
        time.sleep(1.2)
        status = listener.statuses("orchard-mapper")[-1][1]
        mapper.stop()
        listener.close()
        maps[kind] = (os.path.join(out, "map.csv"), status)
    host.close()
    difference, status = Difference(maps["new"][0], maps["mixed"][0]), maps["mixed"][1]
    return [Row("old_types", "every second DETECTIONS of the first release's type: map against new ones alone; refused",
                f"{difference}; {status.num_bad}", "no tree; 0",
                difference.gone + difference.new == 0 and status.num_bad == 0)]


def first_form(data):
    new, old = wire.types.detections_v2_t.decode(data), wire.types.detections_t()
    old.utime, old.seq, old.image_utime = new.utime, new.seq, new.image_utime
    old.num_trunks = new.num_trunks
    old.trunks = []
    for trunk in new.trunks:
        copy = wire.types.trunk_t()
        for name in copy.__slots__:
            setattr(copy, name, getattr(trunk, name))
        old.trunks.append(copy)
    return old.encode()


def calibration(bench, arguments):
    """A camera that is turned, and none at all: what the user sees."""
    drive = Drive(bench, "config/orchard.yaml", arguments.seed, 0.0)
    with open(drive.config) as file:
        text = file.read()
    wrong = os.path.join(bench.work, "turned.yaml")
    with open(wrong, "w") as file:
        # 3 degrees: 12 pixels, two trunks' widths at 4 m
        file.write(text.replace("phi_rad: [1.5788, 0.0065, 1.5628]", "phi_rad: [1.5788, 0.0065, 1.6152]"))
    out = os.path.join(bench.work, "turned")
    done = bench.orchard("map", drive.log, "--config", wrong, "--out", out, check=False)
    said = complaints(done)
    live = live_row("camera turned by 3 degrees", out, driven(bench, wrong, drive.log, arguments.speed))
    turned = Row("calibration", "camera turned by 3 degrees: map; what is said",
                 f"{Difference(drive.map, os.path.join(out, 'map.csv'))}; {clipped(said) or 'nothing'}",
                 "it is said", bool(re.search(r"camera|image|edges|extrinsics|calibr", said, re.I)))
    events = [e for e in wire.read_log(drive.log) if e[1] != "IMAGE"]
    path = os.path.join(bench.work, "no_pictures.lcm")
    wire.write_log(path, events)
    done = bench.orchard("map", path, "--config", drive.config, "--out", out, check=False)
    said = complaints(done)
    missing = Row("calibration", "no picture comes although the rig has a camera: map; what is said",
                  f"{Difference(drive.map, os.path.join(out, 'map.csv'))}; {clipped(said) or 'nothing'}",
                  "it is said", bool(re.search(r"IMAGE|picture|camera", said)))
    live_missing = live_row("no picture comes although the rig has a camera", out,
                            driven(bench, drive.config, path, arguments.speed))
    return [turned, live, missing, live_missing]


def live_row(what, folder, live):
    difference = Difference(os.path.join(folder, "map.csv"), live)
    return Row("calibration", what + ": live against the replay", difference, "the same bytes", difference.same_bytes)

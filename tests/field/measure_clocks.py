# SPDX-License-Identifier: BSD-3-Clause
"""Measurements of clocks that are wrong: steps of an hour, skew between hosts."""
import os
import re
import shutil
import sys
import time

import wire
from drive import Drive
from hosts import Network, lone_host
from maps import Difference
from programs import NODES
from table import Row

CLOCKS = re.compile(r"clock|delay|apart|skew|ahead|behind")
HOUR_us = 3_600_000_000
FAKETIME = "/usr/lib/x86_64-linux-gnu/faketime/libfaketime.so.1"


def complaints(done):
    """What a finished `orchard map` warned of, "" for nothing."""
    lines = (done.stdout + done.stderr).splitlines()
    return " ".join(line for line in lines if "warning" in line or
                    ("losses:" in line and not line.rstrip().endswith("none")))


def altered_map(bench, drive, change):
    """The map of the drive's log after change(utime since the first, channel, bytes), and what was said.

    change gives the new bytes.
    """
    path = altered_log(bench, drive, change)
    done, out = replayed(bench, drive, path)
    said = complaints(done)
    if done.returncode != 0:
        return f"no map (exit code {done.returncode}): {(done.stderr.strip() or '?').splitlines()[-1]}", said, None
    difference = Difference(drive.map, out)
    return str(difference), said, difference


def altered_log(bench, drive, change, forged=()):
    """A log of the changed messages in their order of arrival, with `forged` inserted before its middle."""
    events = wire.read_log(drive.log)
    first = events[0][0]
    changed = [(utime, channel, data if channel == "CONFIG" else change(utime - first, channel, data))
               for utime, channel, data in events]
    path = os.path.join(bench.work, "altered.lcm")
    wire.write_log(path, sorted(changed + list(forged), key=lambda event: event[0]))
    return path


def replayed(bench, drive, path):
    """The finished `orchard map` of a log, and its map.csv."""
    out = os.path.join(bench.work, "altered")
    shutil.rmtree(out, ignore_errors=True)
    return (bench.orchard("map", path, "--config", drive.config, "--out", out, check=False),
            os.path.join(out, "map.csv"))


def driven(bench, config, path, speed, sender_on=None):
    """The map.csv of a log's messages sent as they arrived, by processes of their own.

    sender_on(host): sends all of them, over whatever it starts; without it the source messages are sent.
    """
    out = os.path.join(bench.work, "live")
    shutil.rmtree(out, ignore_errors=True)
    host = lone_host()
    try:
        listener = wire.Listener(host)
        nodes = bench.start_nodes(host, config, out)
        processes = ["orchard-" + name for name in NODES]
        for name in NODES:
            if not listener.wait(lambda status, name=name: status.name == "orchard-" + name, 20):
                raise RuntimeError(f"orchard-{name} does not start: {nodes[name].said()}")
        sender = sender_on(host) if sender_on else wire.Sender(None, socket=wire.udp_socket(host))
        if sender_on and not listener.wait(lambda status: status.name not in processes, 20):
            raise RuntimeError("what translates the messages does not start")
        events = [event for event in wire.read_log(path) if sender_on or event[1] in wire.SOURCES]
        begin = time.monotonic()
        for utime, channel, data in events:
            time.sleep(max(0.0, begin + 1e-6 * (utime - events[0][0]) / speed - time.monotonic()))
            sender.send(channel, data)
        if sender_on:  # a translator is done when it has sent as many
            listener.wait(lambda status: status.name not in processes and status.num_published >= len(events), 20)
        for name in NODES:  # each handles what has arrived before it ends
            if nodes[name].stop() != 0:
                raise RuntimeError(f"orchard-{name}: {nodes[name].said()}")
        listener.close()
    finally:
        bench.close()
        host.close()
    return os.path.join(out, "map.csv")


def set_clock(middle_us, step_us, restarts):
    """Every clock is set by a step in mid-drive; with restarts every driver numbers from 0."""
    begun = {}

    def change(since, channel, data):
        if since <= middle_us:
            return data
        utime, seq = wire.stamp(data)
        first = begun.setdefault(channel, seq)
        return wire.restamped(data, utime + step_us, seq - first if restarts else seq)
    return change


def forged_ones(drive, channel, middle_us, num=6):
    """Messages of tomorrow that follow each other, all at once in mid-drive."""
    events = wire.read_log(drive.log)
    at, _, data = next(e for e in events if e[1] == channel and e[0] - events[0][0] > middle_us)
    utime, seq = wire.stamp(data)
    return [(at - 1, channel, wire.restamped(data, utime + 24 * HOUR_us + 20_000 * i, seq + i))
            for i in range(num)]


def clocks_live(bench, arguments):
    """Clocks set in mid-drive, live: against the clean drive, and against the replay of the same messages."""
    drive = Drive(bench, "config/orchard.yaml", arguments.seed, 20.0 if arguments.short else 0.0)
    middle_us = 8e6 if arguments.short else 57e6
    cases = []
    for step, step_us in (("1 s", 1_000_000), ("1 min", HOUR_us // 60), ("1 h", HOUR_us), ("1 day", 24 * HOUR_us)):
        for way, sign in (("back", -1), ("forward", 1)):
            for restarts in (False, True):
                kind = "numbers from 0" if restarts else "numbers go on"
                cases.append((f"all clocks {step} {way} in mid-drive, {kind}",
                              set_clock(middle_us, sign * step_us, restarts), ()))
    for channel in ("ODOMETRY", "POSE_FIX", "SCAN"):
        cases.append((f"six agreeing {channel} of tomorrow in mid-drive", lambda _, __, data: data,
                      forged_ones(drive, channel, middle_us)))
    found = []
    for what, change, forged in cases:
        path = altered_log(bench, drive, change, forged)
        live = driven(bench, drive.config, path, arguments.speed)
        done, replay = replayed(bench, drive, path)
        if done.returncode != 0:
            found.append(Row("clocks_live", what, done.stderr, "a map", False))
            continue
        to_clean, to_replay = Difference(drive.map, live), Difference(replay, live)
        of_replay = Difference(drive.map, replay)
        differs = [d.gone + d.new for d in (to_clean, to_replay, of_replay)]
        found.append(Row("clocks_live", f"{what}: live against the clean drive; replay against it; live against replay",
                         f"{to_clean}; {of_replay}; {to_replay}", "0 gone, 0 new", not any(differs)))
        print(f"field: {what}: {found[-1].measured}", file=sys.stderr, flush=True)
    return found


def clipped(text, most=160):
    text = re.sub(r"\s+", " ", text).replace("|", "/").strip()
    return text if len(text) <= most else text[:most] + " ..."


def clocks(bench, arguments):
    """Every driver's clock steps by an hour in mid-drive, or one host's runs 200 ms off."""
    drive = Drive(bench, "config/orchard.yaml", arguments.seed, 20.0 if arguments.short else 0.0)
    middle_us = 8e6 if arguments.short else 57e6
    found = []
    for name, step in (("forward", HOUR_us), ("back", -HOUR_us)):
        for restarts in (False, True):
            text, said, difference = altered_map(bench, drive, set_clock(middle_us, step, restarts))
            kind = "and their drivers begin again" if restarts else "in the running drivers"
            found.append(Row("clocks", f"all clocks an hour {name} in mid-drive, {kind}: map of the log; what is said",
                             f"{text}; {clipped(said) or 'nothing'}", "at most 2 trees",
                             difference is not None and difference.gone + difference.new <= 2))
    for channels, what in ((("SCAN",), "SCAN"), (("SCAN", "IMAGE"), "SCAN and IMAGE"), (("IMAGE",), "IMAGE")):
        def skew(_, channel, data, channels=channels):
            utime, _seq = wire.stamp(data)
            return wire.restamped(data, utime + 200_000) if channel in channels else data

        text, said, difference = altered_map(bench, drive, skew)
        if difference is not None:
            live = Difference(os.path.join(bench.work, "altered", "map.csv"),
                              driven(bench, drive.config, os.path.join(bench.work, "altered.lcm"), arguments.speed))
            found.append(Row("clocks", f"the host of {what} runs 200 ms ahead: live against the replay", live,
                             "the same bytes", live.same_bytes))
        found.append(Row("clocks", f"the host of {what} runs 200 ms ahead: map of the log; what is said",
                         f"{text}; {clipped(said) or 'nothing'}", "it is said",
                         re.search(CLOCKS, said) is not None))
    return found


def clock_offset(bench, arguments):
    """Two hosts whose clocks differ, live: who notices, and how soon."""
    drive = Drive(bench, "config/orchard.yaml", arguments.seed)
    if not os.path.exists(FAKETIME):
        return [Row("clock_offset", "libfaketime is not installed", "not measured")]
    found = []
    for name, offset in (("200 ms", "+0.2"), ("an hour", "+3600")):
        out = os.path.join(bench.work, "map")
        shutil.rmtree(out, ignore_errors=True)
        with Network(["sensors", "mapping"]) as network:
            listener = wire.Listener(network["mapping"])
            env = {"LD_PRELOAD": FAKETIME, "FAKETIME": offset, "FAKETIME_DONT_FAKE_MONOTONIC": "1"}
            bench.start_nodes(network["mapping"], drive.config, out)
            begin = time.monotonic()
            bench.start(network["sensors"], "log-player", drive.log, "--config", drive.config,
                        "--speed", "1", "--hold", env=env)
            bench.start(network["sensors"], "sim-driver", "--config", drive.config, "--scene", "orchard",
                        "--wait-for", "nobody", env=env)  # stands for a driver: it sends STATUS alone
            told = listener.wait(lambda s: CLOCKS.search(s.text), 10)
            board = network["mapping"].run([bench.binary("orchard"), "status", "--once", "--lcm-url",
                                            bench.url], check=False)
            shown = re.search(r"[^\n]*(apart|ahead|behind)[^\n]*", board.stdout or "")
            listener.close()
            bench.close()
        words = f"STATUS after {told[0] - begin:.1f} s: {told[1].text}" if told else "STATUS: nothing"
        words += "; orchard status: " + (shown.group(0).strip() if shown else "nothing")
        found.append(Row("clock_offset", f"clocks of two hosts {name} apart: what is said",
                         clipped(words, 300), "it is said", bool(told or shown)))
    return found

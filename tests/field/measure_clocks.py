# SPDX-License-Identifier: BSD-3-Clause
"""Measurements of clocks that are wrong: steps of an hour, skew between hosts."""
import os
import re
import shutil
import time

import wire
from drive import Drive
from hosts import Network
from maps import Difference
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
    events = wire.read_log(drive.log)
    first = events[0][0]
    path, out = os.path.join(bench.work, "altered.lcm"), os.path.join(bench.work, "altered")
    wire.write_log(path, [(utime, channel, data if channel == "CONFIG" else
                           change(utime - first, channel, data)) for utime, channel, data in events])
    done = bench.orchard("map", path, "--config", drive.config, "--out", out, check=False)
    said = complaints(done)
    if done.returncode != 0:
        return f"no map (exit code {done.returncode}): {(done.stderr.strip() or '?').splitlines()[-1]}", said, None
    difference = Difference(drive.map, os.path.join(out, "map.csv"))
    return str(difference), said, difference


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
            begun = {}

            def change(since, channel, data, step=step, restarts=restarts, begun=begun):
                if since <= middle_us:
                    return data
                utime, seq = wire.stamp(data)
                first = begun.setdefault(channel, seq)
                return wire.restamped(data, utime + step, seq - first if restarts else seq)

            text, said, difference = altered_map(bench, drive, change)
            kind = "and their drivers begin again" if restarts else "in the running drivers"
            found.append(Row("clocks", f"all clocks an hour {name} in mid-drive, {kind}: map of the log; what is said",
                             f"{text}; {clipped(said) or 'nothing'}", "at most 2 trees",
                             difference is not None and difference.gone + difference.new <= 2))
    for channels, what in ((("SCAN",), "SCAN"), (("SCAN", "IMAGE"), "SCAN and IMAGE"), (("IMAGE",), "IMAGE")):
        def skew(_, channel, data, channels=channels):
            utime, _seq = wire.stamp(data)
            return wire.restamped(data, utime + 200_000) if channel in channels else data

        text, said, difference = altered_map(bench, drive, skew)
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

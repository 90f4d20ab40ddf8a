# SPDX-License-Identifier: BSD-3-Clause
"""Measurements of clocks that are wrong: steps of an hour, skew between hosts."""
import os
import re
import time

import wire
from drive import Drive
from hosts import Network
from maps import Difference
from programs import NODES
from table import Row

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
                         f"{text}; {clipped(said) or 'nothing'}", "it is said", said != ""))
    return found


def clock_offset(bench, arguments):
    """Two hosts whose clocks differ, live: who notices, and how soon."""
    drive = Drive(bench, "config/orchard.yaml", arguments.seed)
    if not os.path.exists(FAKETIME):
        return [Row("clock_offset", "libfaketime is not installed", "not measured")]
    found = []
    for name, offset in (("200 ms", "+0.2"), ("an hour", "+3600")):
        with Network(["sensors", "mapping"]) as network:
            listener = wire.Listener(network["mapping"])
            env = {"LD_PRELOAD": FAKETIME, "FAKETIME": offset, "FAKETIME_DONT_FAKE_MONOTONIC": "1"}
            for node in NODES:
                bench.start(network["mapping"], node, "--config", drive.config,
                            *(("--out", os.path.join(bench.work, "map")) if node == "mapper" else ()))
            begin = time.monotonic()
            bench.start(network["sensors"], "log-player", drive.log, "--config", drive.config,
                        "--speed", "1", env=env)
            told = listener.wait(lambda s: re.search(r"clock|offset|ahead|behind", s.text), 8)
            programs = [wire.stamp(d) for _, c, d in listener.messages if c == "STATUS"]
            doctor = network["mapping"].run([bench.binary("orchard"), "doctor", "--lcm-url", bench.url], check=False)
            told_by_doctor = re.search(r"[^\n]*clock[^\n]*", doctor.stdout or "", re.I)
            listener.close()
            bench.close()
        words = f"STATUS after {told[0] - begin:.1f} s: {told[1].text}" if told else "STATUS: nothing"
        words += "; doctor: " + (told_by_doctor.group(0) if told_by_doctor else "nothing")
        found.append(Row("clock_offset", f"clocks of two hosts {name} apart: what is said", clipped(words),
                         "it is said", bool((told or told_by_doctor) and programs)))
    return found

# SPDX-License-Identifier: BSD-3-Clause
"""A day: many hours of simulated driving through the real processes, faster than the clock."""
import heapq
import os
import shutil
import struct
import sys
import time

import wire
from drive import Drive
from hosts import lone_host
from maps import rows
from programs import NODES, Program
from table import Row

GAP_us = 3_000_000
GROWTH_most_mib_per_h = 10.0
# Sent to the live mapper ahead of what its STATUS of each second says it has used: as fast as it
# can, and never so far ahead that its inbox, and not its map, is what is measured.
MESSAGES_ahead = 1000
LIVE_h = 1.0  # of the day through the processes: all of it would take half an hour and more


def laser_rig(drive, path):
    """The drive's rig without its camera."""
    with open(drive.config) as file:
        text = file.read()
    text = text.replace("camera:\n  enabled: true", "camera:\n  enabled: false")
    text = text.replace("detector:\n", "detector:\n  tree_threshold: 0.1\n")
    with open(path, "w") as file:
        file.write(text)


def day_log(drive, path, hours, channels=("SCAN", "ODOMETRY", "POSE_FIX", "GNSS"), gap_us=GAP_us):
    """The drive's lap again and again for so many hours, times and numbers going on; its laps."""
    lap = [(wire.stamp(data)[0], channel, data) for _, channel, data in wire.read_log(drive.log)
           if channel in channels]
    first, last = lap[0][0], lap[-1][0]
    length_us = last - first + gap_us
    num_laps = max(1, round(hours * 3.6e9 / length_us))
    count = wire.per_channel(lap)
    num = 0
    with open(path, "wb") as file:
        for number in range(num_laps):
            for utime, channel, data in lap:
                _, seq = wire.stamp(data)
                shifted = wire.restamped(data, utime + number * length_us, seq + number * count[channel])
                name = channel.encode()
                file.write(struct.pack(">IqqII", wire.LOG_MAGIC, num, utime + number * length_us,
                                       len(name), len(data)) + name + shifted)
                num += 1
    return num_laps, length_us / 3.6e9


def bytes_of(path):
    with open(path, "rb") as file:
        return file.read()


def watched(program, seconds, every=0.5):
    """Samples of a program until it ends: memory of its own [MiB], descriptors, threads."""
    samples, end = [], time.monotonic() + seconds
    while program.alive() and time.monotonic() < end:
        samples.append((program.own_memory_mib(), program.descriptors(), program.threads()))
        time.sleep(every)
    return samples


def row_of(name, samples, driven_h):
    """A row on a program: what it needs in the second tenth of the day and in the last, between saves."""
    tenth = max(1, len(samples) // 10)
    early, late = min(samples[tenth:2 * tenth] or samples), min(samples[-1 - tenth:-1] or samples)
    growth = (late[0] - early[0]) / (0.85 * driven_h)
    flat = late[1] <= early[1] + 1 and late[2] <= early[2] + 1  # one more while a save is written; fewer is no miss
    return Row("day", f"{name}: own memory in the second tenth, in the last; at most; per hour; descriptors, threads",
               f"{early[0]:.0f}, {late[0]:.0f} MiB; {max(samples)[0]:.0f} MiB; {growth:.1f} MiB/h; "
               f"{early[1]}, {early[2]} to {late[1]}, {late[2]}",
               f"at most {GROWTH_most_mib_per_h:g} MiB/h; flat", growth <= GROWTH_most_mib_per_h and flat)


def lockstep(bench, host, rig, log, driven_h):
    """Rows on the processes in lockstep, the map's folder, seconds."""
    out = os.path.join(bench.work, "map")
    shutil.rmtree(out, ignore_errors=True)
    nodes = {name: bench.start(host, name, "--config", rig, "--lockstep",
                               *(("--out", out) if name == "mapper" else ())) for name in NODES}
    begin = time.monotonic()
    player = bench.start(host, "log-player", log, "--config", rig, "--lockstep",
                         "--out", os.path.join(bench.work, "derived.lcm"))
    samples = {name: [] for name in ("detector", "pose", "player")}
    next_word = begin + 60
    while player.alive():
        for name in samples:
            program = player if name == "player" else nodes[name]
            samples[name].append((program.own_memory_mib(), program.descriptors(), program.threads()))
        time.sleep(0.5)
        if time.monotonic() > next_word:
            print(f"field: day, lockstep for {time.monotonic() - begin:.0f} s", file=sys.stderr, flush=True)
            next_word += 60
    took = time.monotonic() - begin
    if player.process.returncode != 0:
        raise RuntimeError("orchard-log-player: " + player.said())
    codes = {nodes[name].stop() for name in NODES}
    if codes != {0}:
        raise RuntimeError(f"exit codes {codes}")
    return [row_of(name, samples[name], driven_h) for name in samples], out, took


def live_mapper(bench, host, rig, log, driven_h):
    """Rows on a mapper that runs live through the day, is killed at its end and started again."""
    out = os.path.join(bench.work, "live")
    shutil.rmtree(out, ignore_errors=True)
    mapper = bench.start(host, "mapper", "--config", rig, "--out", out)
    listener, sender = wire.Listener(host), wire.Sender(host, ttl=0)
    listener.wait(lambda s: s.name == "orchard-mapper", 20)
    derived = (e for e in wire.each_event(os.path.join(bench.work, "derived.lcm"))
               if e[1] in ("DETECTIONS", "POSE"))
    sources = (e for e in wire.each_event(log) if e[1] in ("SCAN", "GNSS"))
    samples, next_sample, num, num_used = [], 0.0, 0, 0
    for _, channel, data in heapq.merge(derived, sources, key=lambda e: wire.stamp(e[2])[0]):
        sender.send(channel, data)
        num += 1
        if num % 30 == 0:
            if num - num_used > MESSAGES_ahead:
                told = listener.wait(lambda s: s.name == "orchard-mapper" and
                                     num - s.num_good - s.num_lost <= MESSAGES_ahead, 60)
                num_used = told[1].num_good + told[1].num_lost if told else num
            if time.monotonic() > next_sample:
                next_sample = time.monotonic() + 0.5
                samples.append((mapper.own_memory_mib(), mapper.descriptors(), mapper.threads()))
    time.sleep(3.0)
    before = rows(os.path.join(out, "map.csv"))
    mapper.kill()
    moment = time.monotonic()
    mapper = bench.start(host, "mapper", "--config", rig, "--out", out)
    back = None
    while back is None and time.monotonic() < moment + 300:
        time.sleep(0.02)
        back = next((a for a, s in listener.statuses("orchard-mapper", moment)
                     if not s.text.startswith("starting")), None)
    listener.close()
    code = mapper.stop(seconds=300)
    after = rows(os.path.join(out, "map.csv"))
    return [
        row_of("mapper, live", samples, driven_h),
        Row("day", "killed at its end and started again: back after; landmarks before, after; exit code",
            f"{back - moment:.1f} s; {len(before)}, {len(after)}; {code}" if back else "not within 300 s",
            f"{5.0 * driven_h:.1f} s; the same; 0",
            back is not None and back - moment <= 5.0 * driven_h and len(after) == len(before) and code == 0),
    ]


def mapped(bench, host, rig, log, folder):
    """Bytes of the map.csv that orchard map makes, samples of the program, seconds."""
    begin = time.monotonic()
    program = Program(host, [bench.binary("orchard"), "map", log, "--config", rig, "--out", folder,
                             "--quiet", "--no-derived"], os.path.join(bench.work, "map.log"))
    bench.running.append(program)
    samples = watched(program, 24 * 3600)
    if program.process.returncode != 0:
        raise RuntimeError("orchard map: " + program.said())
    return bytes_of(os.path.join(folder, "map.csv")), samples, time.monotonic() - begin


def live_part(bench, host, rig, drive, hours):
    """Rows on the processes, in lockstep and live, over the first hours of the day."""
    log = os.path.join(bench.work, "part.lcm")
    num_laps, lap_h = day_log(drive, log, hours)
    driven_h = num_laps * lap_h
    found, out, took = lockstep(bench, host, rig, log, driven_h)
    found += live_mapper(bench, host, rig, log, driven_h)
    os.remove(os.path.join(bench.work, "derived.lcm"))
    alone = mapped(bench, host, rig, log, os.path.join(bench.work, "part-alone"))[0]
    os.remove(log)
    same = alone == bytes_of(os.path.join(out, "map.csv"))
    found.append(Row("day", f"{driven_h:.1f} h of driving: map in lockstep and in one process",
                     "the same bytes" if same else "different", "the same bytes", same))
    found.append(Row("day", "the lockstep took", f"{took:.0f} s, {3600 * driven_h / took:.0f} times real time"))
    return found


def day(bench, arguments):
    """Hours of driving: memory, descriptors, threads, the same bytes again, a restart at the end."""
    hours = 0.1 if arguments.short else arguments.hours
    drive = Drive(bench, "config/orchard.yaml", arguments.seed)
    rig, log = os.path.join(bench.work, "laser.yaml"), os.path.join(bench.work, "day.lcm")
    laser_rig(drive, rig)
    host = lone_host()
    bench.url = bench.url.replace("ttl=1", "ttl=0")
    found = live_part(bench, host, rig, drive, min(hours, LIVE_h))
    num_laps, lap_h = day_log(drive, log, hours)
    driven_h = num_laps * lap_h
    first, samples, took = mapped(bench, host, rig, log, os.path.join(bench.work, "once"))
    again, _, _ = mapped(bench, host, rig, log, os.path.join(bench.work, "again"))
    host.close()
    os.remove(log)
    found.append(row_of("orchard map", samples, driven_h))
    found.append(Row("day", f"{driven_h:.1f} h of driving, {num_laps} laps of the drive without its camera: map, twice "
                     "in one process", "the same bytes" if first == again else "different", "the same bytes",
                     first == again))
    found.append(Row("day", "the first of them took", f"{took:.0f} s, {3600 * driven_h / took:.0f} times real time"))
    return found

# SPDX-License-Identifier: BSD-3-Clause
"""Measurements of a full disk: a small tmpfs that only the processes of a host see."""
import os
import shutil
import subprocess
import time

import wire
from drive import Drive
from hosts import lone_host
from maps import rows
from measure_kills import feeder, wait_for_nodes
from programs import Program
from table import Row

DISK = "/mnt"


class Disk:
    """A tmpfs of some kB on a host, and how to fill it."""

    def __init__(self, host, size_kb):
        self.host, self.path = host, f"/proc/{host.keeper.pid}/root{DISK}"
        host.run(f"mount -t tmpfs -o size={size_kb}k tmpfs {DISK}")

    def fill(self, leave_kb=0):
        state = os.statvfs(self.path)
        size = state.f_bavail * state.f_bsize - leave_kb * 1024
        with open(os.path.join(self.path, "ballast"), "wb") as file:
            try:
                while size > 0:
                    size -= os.write(file.fileno(), bytes(min(size, 65536)))
            except OSError:
                pass

    def empty(self):
        os.remove(os.path.join(self.path, "ballast"))


def disk_full(bench, arguments):
    """The disk of map and recording becomes full in mid-drive, and has room again."""
    drive = Drive(bench, "config/orchard.yaml", arguments.seed)
    url = bench.url.replace("ttl=1", "ttl=0")
    bench.url = url
    host = lone_host(mounts=True)
    disk = Disk(host, 30000)
    listener = wire.Listener(host)
    nodes = bench.start_nodes(host, drive.config, DISK + "/map")
    recorder = Program(host, ["lcm-logger", f"--lcm-url={url}", "--flush-interval=100",
                              DISK + "/drive.lcm"], os.path.join(bench.work, "logger.log"))
    bench.running.append(recorder)
    wait_for_nodes(listener)
    begin = time.monotonic() + 0.5
    feeder(bench, host, drive.log, begin, 2.0, wire.SOURCES)
    time.sleep(12.0)
    disk.fill()
    full = time.monotonic()
    told = None
    while told is None and time.monotonic() < full + 10:
        time.sleep(0.02)
        told = next((a for a, s in listener.statuses("orchard-mapper", full) if s.level == 3), None)
    path = os.path.join(disk.path, "map", "map.csv")
    time.sleep(3.0)
    good = len(rows(path))
    recorder_alive = recorder.alive()
    disk.empty()
    mended = time.monotonic()
    time.sleep(0.2)
    well = None
    end = time.monotonic() + 10
    while well is None and time.monotonic() < end:
        last = listener.statuses("orchard-mapper", mended + 0.3)
        well = next((a for a, s in last if s.level != 3), None)
        time.sleep(0.05)
    time.sleep(6.0)
    log = wire.read_log(os.path.join(disk.path, "drive.lcm"))
    recorder.kill()
    os.remove(os.path.join(disk.path, "drive.lcm"))
    disk.fill(leave_kb=150)
    code = nodes["mapper"].stop()
    last = len(rows(path))
    early = bench.start(host, "mapper", "--config", drive.config, "--out", "/proc/1/map")
    try:
        early_code = early.process.wait(5)
    except subprocess.TimeoutExpired:
        early_code = "runs on"
        early.kill()
    listener.close()
    host.close()
    return [
        Row("disk_full", "the mapper says so after; and is well again after room was made",
            f"{told - full:.2f} s; {well - mended:.2f} s" if told and well else "never",
            "1 s; 2 s",
            told is not None and well is not None and told - full <= 1.0 and well - mended <= 2.0),
        Row("disk_full", "rows of the last good map.csv meanwhile", f"{good}", "above 0, all whole", good > 0),
        Row("disk_full", "lcm-logger meanwhile; messages of its log that can be read",
            f"{'runs on' if recorder_alive else 'ended'}; {len(log)}", "above 0", len(log) > 0),
        Row("disk_full", "150 kB left at the end: rows of map.csv; exit code",
            f"{last} (before {good}); {code}", "not fewer; not 0", last >= good and code not in (0, "hangs")),
        Row("disk_full", "a folder that cannot be written, at the start: exit code", f"{early_code}", "1",
            early_code == 1),
    ]


def rotation(bench, arguments):
    """orchard record with a limit: files of their size, no more than the limit in all, every one read."""
    drive = Drive(bench, "config/orchard.yaml", arguments.seed)
    bench.url = bench.url.replace("ttl=1", "ttl=0")
    host = lone_host()
    out = os.path.join(bench.work, "recordings")
    shutil.rmtree(out, ignore_errors=True)
    listener = wire.Listener(host)
    words = [bench.binary("orchard"), "record", "--lcm-url", bench.url, "--out", out, "--split-mb", "1",
             "--keep-gb", "0.005"]
    recorder = Program(host, words, os.path.join(bench.work, "record.log"))
    bench.running.append(recorder)
    listener.wait(lambda s: s.name == "orchard-recorder", 10)
    player = bench.start(host, "log-player", drive.log, "--config", drive.config, "--speed", "4")
    most = 0
    while player.alive():
        most = max(most, sum(entry.stat().st_size for entry in os.scandir(out)))
        time.sleep(0.1)
    time.sleep(1.0)
    code = recorder.stop()
    files = sorted(os.scandir(out), key=lambda entry: entry.name)
    largest = max(entry.stat().st_size for entry in files)
    kept = [event for entry in files for event in wire.read_log(entry.path)]
    sent = wire.per_channel(wire.read_log(drive.log))["SCAN"]
    last = max((wire.stamp(data)[1] for _, channel, data in kept if channel == "SCAN"), default=-1)
    numbers = sorted(wire.stamp(data)[1] for _, channel, data in kept if channel == "SCAN")
    whole = numbers == list(range(numbers[0], numbers[-1] + 1)) if numbers else False
    listener.close()
    host.close()
    return [
        Row("rotation", "recording of 20 MB split at 1 MB, 5 MB kept and one file written: at most in all",
            f"{most / 1e6:.1f} MB; the largest file {largest / 1e6:.2f} MB", "6 MB", most <= 6e6),
        Row("rotation", "its last scan, gaps in what is kept, exit code",
            f"{last + 1} of {sent}, {'none' if whole else 'some'}, {code}", "the newest, none, 0",
            last + 1 == sent and whole and code == 0),
    ]

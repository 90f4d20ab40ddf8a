# SPDX-License-Identifier: BSD-3-Clause
"""orchard live with every sensor played at its real protocol, a simulated orchard behind them."""
import glob
import math
import os
import shutil
import subprocess
import sys
import time

import wire
from drive import Drive
from hosts import Network, lone_host
from maps import Difference
from measure_clocks import driven
from measure_day import laser_rig
from programs import Program
from table import Row

REAR = """
laser_rear:
  enabled: true
  mount_x_m: -0.35
  mount_yaw_rad: 3.141592653589793
  range_sd_m: 0.012
  range_sd_fraction: 0.001
"""

PATH = """
pose:
  mode: slam
  slam:
    use_gnss: true
  gnss:
    datum: [-27.6040, 151.9320, 690.0]
"""


def rig(path, rear):
    """The orchard's rig without the fixes, which no device gives: wheels, trunks and RTK place it."""
    with open("config/orchard.yaml") as file:
        text = file.read()
    text = text.replace("fix_rate_hz: 10.0", "fix_rate_hz: 0")
    text = text.replace("gnss_rate_hz: 5.0", "gnss_rate_hz: 5.0\n    gnss_sd_m: 0.02")
    with open(path, "w") as file:
        file.write(text + PATH + (REAR if rear else ""))
    return path


def processor_s(parent):
    """Processor time of the processes that a process has started, by name [s]."""
    ticks = os.sysconf("SC_CLK_TCK")
    used = {}
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{pid}/stat") as file:
                name, rest = file.read().split("(", 1)[1].rsplit(")", 1)
            with open(f"/proc/{pid}/cmdline", "rb") as file:
                program = os.path.basename(file.read().split(b"\0")[0].decode())
        except OSError:
            continue
        fields = rest.split()
        if int(fields[1]) == parent:
            used[program] = (int(fields[11]) + int(fields[12])) / ticks
    return used


def one(bench, arguments, rear):
    words = "two scanners" if rear else "one scanner"
    seconds = 20.0 if arguments.short else 60.0
    stem = os.path.join(bench.work, "two" if rear else "one")
    config = rig(stem + ".yaml", rear)
    bench.orchard("simulate", "--scene", "orchard", "--seed", arguments.seed, "--config", config,
                  "--duration", seconds, "--out", stem + ".lcm")
    bench.orchard("map", stem + ".lcm", "--out", stem, "--quiet")
    shutil.rmtree(stem + "-live", ignore_errors=True)
    with Network(["robot"], bench.impaired_link) as network:
        live = Program(network["robot"], [bench.binary("orchard"), "live", config, "--emulate", stem + ".lcm",
                                          "--out", stem + "-live"], stem + ".log")
        bench.running.append(live)
        begin = time.monotonic()
        while live.alive() and time.monotonic() - begin < 3.0:
            time.sleep(0.1)
        before = processor_s(live.pid)
        while live.alive() and time.monotonic() - begin < 3.0 + seconds:
            time.sleep(0.1)
        after = processor_s(live.pid)
        while live.alive() and time.monotonic() - begin < 6.0 + seconds:
            time.sleep(0.1)
        code = live.stop()
    difference = Difference(os.path.join(stem, "map.csv"), os.path.join(stem + "-live", "map.csv"))
    percent = {name: 100.0 * (after[name] - before.get(name, 0.0)) / seconds for name in after}
    of_drivers = sum(value for name, value in percent.items() if name.endswith("driver"))
    close = difference.gone == 0 and difference.new == 0 and difference.offset_most_mm <= 5.0
    return [
        Row("emulated", f"{words} by SCIP, camera, gpsd and wheels, {seconds:g} s: the map against that "
            "of the simulator's own messages", difference, "each tree within 5 mm", close and code == 0),
        Row("emulated", f"{words}: processor of all processes; of it the drivers, each with the "
            "emulated device in it", f"{sum(percent.values()):.1f} % of one core; {of_drivers:.1f} %",
            "at most 8 %", sum(percent.values()) <= 8.0),
    ]


def emulated(bench, arguments):
    """orchard live with every sensor at its real protocol: the map, and what it costs."""
    bench.impaired_link = os.path.join(bench.build, "tests", "field", "impaired_link")
    return one(bench, arguments, False) + one(bench, arguments, True)


ROBOT_PORT = 7668  # the network of a robot that speaks libbot's types
LIBBOT = """
drivers:
  bot_core:
    lcm_url: udpm://239.255.76.67:7668?ttl=0
    pose_as: pose_fix
    range_max_m: 20.0
"""


def as_libbot(log, path, types):
    """A log's scans and fixes as a robot with libbot would have recorded them; how many."""
    events = []
    for utime, channel, data in wire.read_log(log):
        if channel == "SCAN":
            scan, lidar = wire.types.scan_t.decode(data), types.planar_lidar_t()
            lidar.utime, lidar.nranges, lidar.ranges = scan.utime, scan.num_ranges, scan.ranges_m
            lidar.rad0, lidar.radstep = scan.bearing_min_rad, scan.bearing_step_rad
            events.append((utime, "HOKUYO", lidar.encode()))
        elif channel == "POSE_FIX":
            fix, pose = wire.types.pose_fix_t.decode(data), types.pose_t()
            pose.utime, pose.pos = fix.utime, (fix.x_m, fix.y_m, 0.0)
            pose.orientation = (math.cos(fix.yaw_rad / 2), 0.0, 0.0, math.sin(fix.yaw_rad / 2))
            events.append((utime, "BODY", pose.encode()))
    wire.write_log(path, events)
    return len(events)


def bot_core(bench, arguments):
    """A robot that speaks libbot's types: its live map against that of its recording, imported."""
    drive = Drive(bench, "config/orchard.yaml", arguments.seed, 20.0 if arguments.short else 0.0)
    subprocess.run(["lcm-gen", "--python", "--ppath", bench.work, *sorted(glob.glob("lcmtypes/bot_core/*.lcm"))], check=True)
    sys.path.insert(0, bench.work)
    import bot_core as types
    rig, log = os.path.join(bench.work, "rig.yaml"), os.path.join(bench.work, "robot.lcm")
    laser_rig(drive, rig)
    with open(rig, "a") as file:
        file.write(LIBBOT)
    num = as_libbot(drive.log, log, types)
    imported, out = os.path.join(bench.work, "imported.lcm"), os.path.join(bench.work, "imported")
    bench.orchard("import", log, "--config", rig, "--out", imported)
    shutil.rmtree(out, ignore_errors=True)
    bench.orchard("map", imported, "--config", rig, "--out", out, "--quiet")

    def adapter(host):
        bench.start(host, "bot-core-adapter", "--config", rig)
        return wire.Sender(None, socket=wire.udp_socket(host), port=ROBOT_PORT)

    live = driven(bench, rig, log, arguments.speed, adapter)
    difference = Difference(os.path.join(out, "map.csv"), live)
    return [Row("bot_core", f"{num} planar_lidar_t and pose_t through the live adapter: map against that of the imported log",
                difference, "the same bytes", difference.same_bytes and difference.num > 0)]

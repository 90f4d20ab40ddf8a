# SPDX-License-Identifier: BSD-3-Clause
"""What a stranger on the network can do to a robot that works."""
import os
import time

import wire
from attacks import ATTACKS, random_packets
from drive import Drive
from hosts import Network
from measure_kills import feeder
from programs import NODES, Program, seeded
from table import Row

GROWTH_most_mib = 64.0


def sample_of(drive):
    """A message of each channel, from the middle of the drive."""
    events = wire.read_log(drive.log) + wire.read_log(os.path.join(drive.folder, "derived.lcm"))
    found = {}
    for channel in {channel for _, channel, _ in events}:
        of_it = [data for _, name, data in events if name == channel]
        found[channel] = of_it[len(of_it) // 2]
    return {name: data for name, data in found.items() if len(data) < 60000}


class Victims:
    """Detector, pose, mapper and who only listens, with a driver that plays a drive; started anew for each attack."""

    def __init__(self, bench, robot, drive, listener):
        self.nodes = bench.start_nodes(robot, drive.config, os.path.join(bench.work, "map"))
        words = [bench.binary("orchard"), "echo", "--lcm-url", bench.url]
        self.nodes["echo"] = Program(robot, [*words, "DETECTIONS"], os.path.join(bench.work, "echo.log"))
        self.nodes["lcm-logger"] = bench.start_logger(robot, os.path.join(bench.work, "heard.lcm"))
        bench.running.append(self.nodes["echo"])
        since = time.monotonic()
        end = since + 20
        while time.monotonic() < end and not all(
                listener.statuses("orchard-" + name, since) for name in NODES):
            time.sleep(0.05)
        self.begin = time.monotonic() + 0.2
        self.feeder = feeder(bench, robot, drive.log, self.begin, 1.0, wire.SOURCES)

    def dead(self):
        return [name for name, program in self.nodes.items() if not program.alive()]

    def memory_mib(self):
        return {name: program.memory_mib() for name, program in self.nodes.items()}

    def stop(self, bench):
        codes = {}
        self.feeder.kill()
        for name in ("echo", "detector", "pose", "mapper", "lcm-logger"):
            codes[name] = self.nodes[name].stop(seconds=15)
        bench.running = []
        return codes


def rate(listener, channel, seconds):
    before = listener.count.get(channel, 0)
    time.sleep(seconds)
    return (listener.count.get(channel, 0) - before) / seconds


def hostile(bench, arguments):
    """Each attack by a stranger's host while a drive is mapped: who dies, freezes, grows."""
    drive = Drive(bench, "config/orchard.yaml", arguments.seed)
    sample, random = sample_of(drive), seeded(arguments.seed)
    found = []
    with Network(["robot", "stranger"]) as network:
        listener = wire.Listener(network["robot"])
        sender = wire.Sender(network["stranger"])
        for attack in ATTACKS:
            if arguments.short and attack.__name__ in ("million_points", "flood"):
                continue
            victims = Victims(bench, network["robot"], drive, listener)
            time.sleep(3.0)
            rates_before = {name: rate_of(listener, name) for name in ("DETECTIONS", "POSE")}
            before = victims.memory_mib()
            if attack is random_packets:
                attack(sender, random, sample, arguments.num or (4000 if arguments.short else 100_000))
            else:
                attack(sender, random, sample)
            time.sleep(1.5)
            after = victims.memory_mib()
            flows = {name: rate(listener, name, 1.5) for name in ("DETECTIONS", "POSE")}
            dead = victims.dead()
            grown = {name: after[name] - before[name] for name in after
                     if name not in dead and after[name] - before[name] > GROWTH_most_mib}
            silent = [channel for channel, now in flows.items() if now < 0.5 * rates_before[channel]
                      or now == 0]
            codes = victims.stop(bench)
            slow = [name for name, code in codes.items() if code == "hangs" and name not in dead]
            ours = [name for name in dead if name != "lcm-logger"]
            words = []
            if dead:
                words.append("dead: " + ", ".join(dead))
            if silent and not ours:
                words.append("no more: " + ", ".join(silent))
            if grown:
                words.append("grown: " + ", ".join(f"{n} by {g:.0f} MiB" for n, g in grown.items()))
            if slow:
                words.append("not stopped in 15 s: " + ", ".join(slow))
            found.append(Row("hostile", attack.__doc__.split("\n")[0].rstrip("."),
                             "; ".join(words) or "nobody dies, freezes or grows",
                             "nobody of ours dies, freezes, grows",
                             not (ours or silent or slow or set(grown) - {"lcm-logger"})))
            print(f"field: hostile, {attack.__name__}: {found[-1].measured}", flush=True)
        listener.close()
    return found


def rate_of(listener, channel):
    return rate(listener, channel, 0.75)

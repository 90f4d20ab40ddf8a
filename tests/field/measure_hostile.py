# SPDX-License-Identifier: BSD-3-Clause
"""What a stranger on the network can do to a robot that works."""
import os
import shutil
import sys
import time

import wire
from attacks import ATTACKS, random_packets
from drive import Drive
from hosts import Network
from measure_kills import feeder
from programs import NODES, Program, seeded
from table import Row

GROWTH_most_mib = 64.0
RECOVERY_s = 2.0  # after an attack what is real flows again
WATCHED = ("DETECTIONS", "POSE")


def sample_of(drive):
    """A message of each channel, from about the time of the drive at which the attacks come."""
    events = wire.read_log(drive.log) + wire.read_log(os.path.join(drive.folder, "derived.lcm"))
    found = {}
    for channel in {channel for _, channel, _ in events}:
        of_it = [data for _, name, data in events if name == channel]
        found[channel] = of_it[len(of_it) // 20]
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
    return attacked(bench, arguments, "hostile", guard=None)


def hostile_guarded(bench, arguments):
    """The same behind the rules of config/deploy/lcm-guard.nft: lcm-logger, too, goes on."""
    if shutil.which("nft") is None:
        return [Row("hostile_guarded", "nft is not installed", "not measured")]
    return attacked(bench, arguments, "hostile_guarded", guard="config/deploy/lcm-guard.nft")


def attacked(bench, arguments, name, guard):
    drive = Drive(bench, "config/orchard.yaml", arguments.seed)
    sample, random = sample_of(drive), seeded(arguments.seed)
    found = []
    with Network(["robot", "stranger"]) as network:
        if guard:
            network["robot"].run(["nft", "-f", os.path.abspath(guard)])
        listener = wire.Listener(network["robot"])
        sender = wire.Sender(network["stranger"])
        for attack in ATTACKS:
            if arguments.short and attack.__name__ in ("million_points", "flood"):
                continue
            victims = Victims(bench, network["robot"], drive, listener)
            time.sleep(3.0)
            flows_before = {channel: rate(listener, channel, 1.0) for channel in WATCHED}
            before = victims.memory_mib()
            if attack is random_packets:
                attack(sender, random, sample, arguments.num or (4000 if arguments.short else 100_000))
            else:
                attack(sender, random, sample)
            time.sleep(RECOVERY_s)
            after = victims.memory_mib()
            flows = {channel: rate(listener, channel, 1.5) for channel in WATCHED}
            dead = victims.dead()
            grown = {n: after[n] - before[n] for n in after
                     if n not in dead and after[n] - before[n] > GROWTH_most_mib}
            silent = [channel for channel in WATCHED if flows[channel] < 0.5 * flows_before[channel]]
            codes = victims.stop(bench)
            slow = [n for n, code in codes.items() if code == "hangs" and n not in dead]
            row = judged(name, attack, dead, silent, grown, slow, bool(guard))
            found.append(row)
            print(f"field: {name}, {attack.__name__}: {row.measured}", file=sys.stderr, flush=True)
        listener.close()
    return found


def judged(name, attack, dead, silent, grown, slow, with_logger):
    """The row of an attack; lcm-logger counts only behind the guard."""
    mine = [n for n in dead if with_logger or n != "lcm-logger"]
    words = []
    if dead:
        words.append("dead: " + ", ".join(dead))
    if silent and not [n for n in dead if n != "lcm-logger"]:
        words.append("no more: " + ", ".join(silent))
    if grown:
        words.append("grown: " + ", ".join(f"{n} by {g:.0f} MiB" for n, g in grown.items()))
    if slow:
        words.append("not stopped in 15 s: " + ", ".join(slow))
    large = [n for n in grown if with_logger or n != "lcm-logger"]
    return Row(name, attack.__doc__.split("\n")[0].rstrip("."),
               "; ".join(words) or "nobody dies, freezes or grows",
               "nobody" if with_logger else "nobody of ours", not (mine or silent or large or slow))

# SPDX-License-Identifier: BSD-3-Clause
"""One drive between two hosts: the sensors on one, detector, pose and mapper on the other."""
import hashlib
import os
import shutil
import time

import wire
from hosts import ADVISED_SYSCTLS, Network
from maps import Difference
from programs import NODES


class Drive:
    """A simulated log, and the map that it gives in one process."""

    def __init__(self, bench, config, seed, seconds=0.0):
        self.config, self.seed = os.path.abspath(config), seed
        # What the log and its map are made by is in the name: a map of other programs is no reference.
        made_by = hashlib.sha256()
        for path in (self.config, os.path.join(bench.build, "bin", "orchard")):
            with open(path, "rb") as file:
                made_by.update(file.read())
        name = (f"drive-{os.path.basename(config).split('.')[0]}-{seed}-{seconds:g}-"
                f"{made_by.hexdigest()[:12]}")
        self.folder = os.path.join(os.path.dirname(bench.work), "drives", name)
        os.makedirs(os.path.dirname(self.folder), exist_ok=True)
        self.log = self.folder + ".lcm"
        if not os.path.exists(os.path.join(self.folder, "map.csv")):
            bench.orchard("simulate", "--scene", "orchard", "--seed", seed, "--config", config,
                          "--duration", seconds, "--out", self.log)
            bench.orchard("map", self.log, "--config", config, "--out", self.folder, "--quiet")
        self.map = os.path.join(self.folder, "map.csv")


class TwoHosts:
    """What came of a drive over a link."""

    def __init__(self, bench, drive, speed, impair, sysctls=None, during=None, rate_mbit=None,
                 recorder_on_b=True, beside_sensors=()):
        bench.impaired_link = os.path.join(bench.build, "tests", "field", "impaired_link")
        out = os.path.join(bench.work, "two_hosts")
        shutil.rmtree(out, ignore_errors=True)
        os.makedirs(out)
        heard = os.path.join(bench.work, "heard.lcm")
        network = Network(["sensors", "mapping"], bench.impaired_link,
                          {"mapping": impair} if impair is not None else None,
                          ADVISED_SYSCTLS if sysctls is None else sysctls)
        with network:
            sensors, mapping = network["sensors"], network["mapping"]
            if rate_mbit:
                sensors.run(f"tc qdisc add dev eth0 root tbf rate {rate_mbit}mbit burst 32kb latency 400ms")
            listener = wire.Listener(mapping)
            logger = bench.start_logger(mapping, heard) if recorder_on_b else None
            nodes = bench.start_nodes(mapping, drive.config, out,
                                      [name for name in NODES if name not in beside_sensors])
            nodes.update(bench.start_nodes(sensors, drive.config, out, beside_sensors))
            player = bench.start(sensors, "log-player", drive.log, "--config", drive.config, "--speed",
                                 speed, "--wait-for", ",".join(NODES))
            if during:
                during(self, network, listener, nodes)
            if player.process.wait(3600) != 0:
                raise RuntimeError("orchard-log-player: " + player.said())
            time.sleep(1.5)
            self.status = {name: (listener.statuses("orchard-" + name) or [(0, None)])[-1][1]
                           for name in NODES}
            self.codes = {name: nodes[name].stop() for name in ("detector", "pose", "mapper")}
            # the last STATUS counts what came at the end, too
            time.sleep(0.2)
            self.status = {name: (listener.statuses("orchard-" + name) or [(0, None)])[-1][1]
                           for name in NODES}
            if logger:
                logger.stop()
            self.listener = listener
            listener.close()
        bench.running = []
        self.link = network.counts.get("mapping", {})
        self.played, self.heard = wire.read_log(drive.log), wire.read_log(heard) if recorder_on_b else []
        self.map = os.path.join(out, "map.csv")
        self.compared = Difference(drive.map, self.map)
        # With the detector on the other host, its scans are not those that were heard here.
        self.replay = self.replayed(bench, drive, heard) if recorder_on_b and not beside_sensors else None

    def replayed(self, bench, drive, heard):
        """The live map against that of what its host has heard."""
        out = os.path.join(bench.work, "replayed")
        shutil.rmtree(out, ignore_errors=True)
        bench.orchard("map", heard, "--config", drive.config, "--out", out, "--quiet")
        return Difference(os.path.join(out, "map.csv"), self.map)

    def true_loss(self, channels):
        """Messages of these channels that one host played and the other did not hear, and all played."""
        sent, heard = wire.per_channel(self.played), wire.per_channel(self.heard)
        num_sent = sum(sent.get(name, 0) for name in channels)
        return num_sent - sum(min(heard.get(n, 0), sent.get(n, 0)) for n in channels), num_sent

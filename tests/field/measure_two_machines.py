# SPDX-License-Identifier: BSD-3-Clause
"""The page config/deploy/README.md, typed by somebody who has nothing else, on two hosts."""
import os
import re
import shutil
import subprocess
import time

import wire
from hosts import Network
from maps import Difference, rows
from measure_clocks import clipped
from table import Row

PAGE = "config/deploy/README.md"


def commands(page, machine):
    """The lines of the page's blocks for a machine: blocks begin with a comment that names it."""
    with open(page) as file:
        blocks = re.findall(r"```sh\n# ([^\n]+)\n(.*?)```", file.read(), re.S)
    lines = [line for name, block in blocks if name == machine for line in block.strip().split("\n")]
    if not lines:
        raise RuntimeError(f"{page} has no block of commands for {machine}")
    return lines


def wanted_sysctls(terminal):
    """Whether what a namespace can change is as the page's file wants it."""
    return terminal.type('test "$(cat /proc/sys/net/ipv4/ipfrag_time)" = 3') == 0


class Terminal:
    """A shell of a user on a host; what is typed, and what it says."""

    def __init__(self, bench, host, name):
        self.home = os.path.join(bench.work, name)
        shutil.rmtree(self.home, ignore_errors=True)
        tools = os.path.join(self.home, "bin")
        os.makedirs(tools)
        with open(os.path.join(tools, "sudo"), "w") as file:
            file.write('#!/bin/sh\nexec "$@"\n')  # the namespaces' user is root already
        os.chmod(os.path.join(tools, "sudo"), 0o755)
        env = {"PATH": f"{tools}:{bench.build}/bin:/usr/sbin:/usr/bin:/sbin:/bin", "HOME": self.home,
               "LC_ALL": "C.UTF-8",
               **{name: value for name, value in os.environ.items() if name.endswith("SAN_OPTIONS")}}
        self.said = os.path.join(self.home, "terminal.txt")
        with open(self.said, "wb") as file:
            self.shell = subprocess.Popen(host.enter + ["bash"], stdin=subprocess.PIPE, stdout=file,
                                          stderr=file, env=env, text=True)
        self.number = 0

    def type(self, line, seconds=20):
        """Types a line and waits for its end; the exit code, None when it takes longer."""
        self.number += 1
        mark = os.path.join(self.home, f"done-{self.number}")
        self.shell.stdin.write(f"{line}\necho $? >{mark}.part; mv {mark}.part {mark}\n")
        self.shell.stdin.flush()
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if os.path.exists(mark):
                with open(mark) as file:
                    return int(file.read())
            time.sleep(0.02)
        return None

    def close(self):
        """Ends what runs in the background as Ctrl-C would, one after the other, and the shell."""
        self.type("for job in $(jobs -p); do kill -TERM $job; wait $job; done", 60)
        self.shell.stdin.write("exit\n")
        self.shell.stdin.close()
        self.shell.wait(10)


def two_machines(bench, arguments):
    """The documented set-up of two machines, typed from its page: the map is that of one machine."""
    failed = []
    with Network(["mapping", "sensors"], multicast_route=False) as network:
        mapping = Terminal(bench, network["mapping"], "mapping")
        sensors = Terminal(bench, network["sensors"], "sensors")

        def type_all(terminal, machine, seconds=20):
            for line in commands(PAGE, machine):
                if "sim-driver" in line and arguments.short:
                    line = line.replace("orchard-sim-driver", "orchard-sim-driver --speed 6")
                code = terminal.type(line, seconds)
                # of that file the kernel lets no namespace change net.core.rmem_max
                fails_here = "sysctl" in line and wanted_sysctls(terminal)
                if code != 0 and not fails_here:
                    failed.append(f"{line} ({'does not end' if code is None else code})")

        for terminal in (mapping, sensors):
            type_all(terminal, "both machines")
        type_all(mapping, "mapping machine")
        type_all(sensors, "either machine")
        listener = wire.Listener(network["mapping"])
        type_all(sensors, "sensors' machine", 240)
        time.sleep(1.5)
        listener.close()
        mapping.close()
        sensors.close()
    log, live = os.path.join(sensors.home, "drive.lcm"), os.path.join(mapping.home, "map", "map.csv")
    one = os.path.join(bench.work, "one_machine")
    bench.orchard("map", log, "--config", os.path.join(sensors.home, "rig.yaml"), "--out", one, "--quiet")
    simulated = os.path.join(bench.work, "simulated")
    bench.orchard("simulate", "--scene", "orchard", "--seed", 7, "--config", "config/orchard.yaml",
                  "--out", simulated + ".lcm")
    bench.orchard("map", simulated + ".lcm", "--config", "config/orchard.yaml", "--out", simulated, "--quiet")
    # In seconds, on a machine with other things to do, pictures are dropped: then only the commands are judged.
    difference = Difference(os.path.join(one, "map.csv"), live)
    other = Difference(os.path.join(simulated, "map.csv"), live)
    return [
        Row("two_machines", "commands of the page that fail", clipped("; ".join(failed)) or "none", "none",
            not failed),
        Row("two_machines", "map of two machines against the recording's on one", str(difference),
            "equal", len(rows(live)) > 0 if arguments.short else difference.same_bytes and len(rows(live)) > 0),
        Row("two_machines", "and against the simulated log's", str(other), "equal",
            None if arguments.short else other.same_bytes),
    ]

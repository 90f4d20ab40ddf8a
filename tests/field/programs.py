# SPDX-License-Identifier: BSD-3-Clause
"""Starts, watches and stops the programs of a build on a host."""
import os
import random
import signal
import subprocess
import time

from hosts import URL, in_thread

NODES = ("detector", "pose", "mapper")


class Program:
    """One process of a host; its output goes into a file."""

    def __init__(self, host, words, log, env=None):
        self.words, self.log = [str(word) for word in words], log
        with open(log, "ab") as file:
            self.process = subprocess.Popen(host.enter + self.words, stdout=file, stderr=file,
                                            env={**os.environ, **(env or {})})
        self.pid = self.process.pid

    def alive(self):
        return self.process.poll() is None

    def stop(self, number=signal.SIGINT, seconds=20):
        """The exit code, "hangs" when it had to be killed."""
        if self.alive():
            self.process.send_signal(number)
        try:
            return self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            return "hangs"

    def kill(self):
        if self.alive():
            self.process.kill()
        self.process.wait()

    def memory_mib(self):
        return self.number("VmRSS:") / 1024

    def own_memory_mib(self):
        """Without the pages of files, which the kernel takes back when it needs them."""
        return (self.number("RssAnon:") + self.number("RssShmem:")) / 1024

    def threads(self):
        return self.number("Threads:")

    def number(self, key):
        try:
            with open(f"/proc/{self.pid}/status") as file:
                return int(file.read().split(key)[1].split()[0])
        except (OSError, IndexError):
            return 0

    def descriptors(self):
        try:
            return len(os.listdir(f"/proc/{self.pid}/fd"))
        except OSError:
            return 0

    def said(self, lines=3):
        with open(self.log, errors="replace") as file:
            return " | ".join(file.read().strip().split("\n")[-lines:])


class Bench:
    """Where the programs are, where they write, and on which network they speak."""

    def __init__(self, build, work, url=URL):
        self.build, self.work, self.url, self.running = build, work, url, []
        os.makedirs(work, exist_ok=True)

    def binary(self, name):
        return os.path.join(self.build, "bin", name)

    def start(self, host, name, *options, env=None, url=None):
        """orchard-NAME on a host."""
        words = [self.binary("orchard-" + name), "--lcm-url", url or self.url, *options]
        program = Program(host, words, os.path.join(self.work, f"{name}.log"), env)
        self.running.append(program)
        return program

    def start_nodes(self, host, config, out, names=NODES):
        return {name: self.start(host, name, "--config", config,
                                 *(("--out", out) if name == "mapper" else ())) for name in names}

    def start_logger(self, host, path):
        if os.path.exists(path):
            os.remove(path)
        program = Program(host, ["lcm-logger", f"--lcm-url={self.url}", "--flush-interval=100", path],
                          os.path.join(self.work, "logger.log"))
        self.running.append(program)
        end = time.monotonic() + 5
        while not os.path.exists(path) and time.monotonic() < end:
            time.sleep(0.02)
        return program

    def orchard(self, *words, check=True):
        return subprocess.run([self.binary("orchard"), *[str(word) for word in words]], check=check,
                              capture_output=True, text=True)

    def close(self):
        for program in self.running:
            program.kill()
        self.running = []


class Supervised:
    """Starts a program anew whenever it ends, as systemd's Restart=always with RestartSec=0."""

    def __init__(self, start):
        self.start, self.stopping, self.num_starts = start, False, 0
        self.program = None
        self.begin()
        self.thread = in_thread(self.keep)

    def begin(self):
        self.program = self.start()
        self.num_starts += 1

    def keep(self):
        while not self.stopping:
            try:
                self.program.process.wait(0.02)
            except subprocess.TimeoutExpired:
                continue
            if not self.stopping:
                self.begin()

    def kill(self):
        self.program.process.kill()

    def stop(self, number=signal.SIGINT):
        self.stopping = True
        self.thread.join()
        return self.program.stop(number)


def seeded(seed):
    return random.Random(seed)

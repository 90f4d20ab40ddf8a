# SPDX-License-Identifier: BSD-3-Clause
"""Hosts as network namespaces, joined by a bridge; one of them behind a link that can be bad."""
import contextlib
import ctypes
import fcntl
import os
import signal
import socket
import struct
import subprocess
import threading

CLONE_NEWNET = 0x40000000
SIOCETHTOOL = 0x8946
ETHTOOL_STXCSUM = 0x17
LIBC = ctypes.CDLL(None, use_errno=True)
# Beyond one machine: a hop of one, and a buffer for bursts.
URL = "udpm://239.255.76.67:7667?ttl=1&recv_buf_size=4194304"

# What SECURITY.md and config/deploy/README.md recommend against half messages that fill the kernel's store.
ADVISED_SYSCTLS = {"net/ipv4/ipfrag_time": "3", "net/ipv4/ipfrag_high_thresh": "33554432"}


@contextlib.contextmanager
def network_of(pid):
    """This thread's sockets belong to the network of a process while the block runs."""
    own = os.open("/proc/thread-self/ns/net", os.O_RDONLY)
    other = os.open(f"/proc/{pid}/ns/net", os.O_RDONLY)
    try:
        if LIBC.setns(other, CLONE_NEWNET) != 0:
            raise OSError(ctypes.get_errno(), "setns")
        yield
    finally:
        LIBC.setns(own, CLONE_NEWNET)
        os.close(own)
        os.close(other)


def no_transmit_checksum(interface):
    """Frames leave with whole checksums: a packet socket does not finish them."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        command = ctypes.create_string_buffer(struct.pack("II", ETHTOOL_STXCSUM, 0))
        request = struct.pack("16sP", interface.encode(), ctypes.addressof(command))
        fcntl.ioctl(control, SIOCETHTOOL, request)


class Host:
    """A namespace of network, host name and perhaps mounts, kept by a process that does nothing."""

    def __init__(self, name, mounts=False):
        self.name = name
        own = ["-n", "-u"] + (["-m"] if mounts else [])
        self.keeper = subprocess.Popen(
            ["unshare", *own, "sh", "-c", 'hostname "$1"; echo; exec sleep infinity', "sh", name],
            stdout=subprocess.PIPE)
        self.keeper.stdout.readline()
        self.enter = ["nsenter", "-t", str(self.keeper.pid), *own]
        self.run("ip link set lo up")

    def run(self, command, check=True):
        words = command.split() if isinstance(command, str) else command
        return subprocess.run(self.enter + words, check=check, capture_output=True, text=True)

    def sysctl(self, values):
        for key, value in values.items():
            self.run(["sh", "-c", f"echo {value} > /proc/sys/{key}"])

    def network(self):
        return network_of(self.keeper.pid)

    def close(self):
        self.keeper.kill()
        self.keeper.wait()


class Link:
    """tests/field/impaired_link between two interfaces of the hub."""

    def __init__(self, hub, program, ends, options):
        words = [str(word) for pair in options.items() for word in pair]
        self.process = subprocess.Popen(hub.enter + [program, *ends, *words],
                                        stdout=subprocess.PIPE, text=True)
        if self.process.stdout.readline().strip() != "ready":
            raise RuntimeError("impaired_link does not start")

    def cut(self):
        self.process.send_signal(signal.SIGUSR1)

    def mend(self):
        self.process.send_signal(signal.SIGUSR2)

    def close(self):
        """Ends the link; its counts by name."""
        self.process.terminate()
        words = self.process.communicate()[0].split()
        return {name: int(value) for name, value in zip(words[::2], words[1::2])}


class Network:
    """Two hosts or more on a bridge; `impair` names the host whose cable is bad, and how.

    impair: {"b": {"--loss": 0.05, "--seed": 1}}; program: the built impaired_link.
    """

    def __init__(self, names, program=None, impair=None, sysctls=None, multicast_route=True):
        self.hub = Host("hub")
        self.hub.run("ip link add br0 type bridge")
        self.hub.run("ip link set br0 type bridge mcast_snooping 0")
        self.hub.run("ip link set br0 up")
        self.hosts, self.links = {}, {}
        for number, name in enumerate(names):
            host = self.hosts[name] = Host(name)
            pid = host.keeper.pid
            self.hub.run(f"ip link add port{number} type veth peer name eth0 netns {pid}")
            host.run(f"ip addr add 10.76.67.{number + 1}/24 dev eth0")
            host.run("ip link set eth0 up")
            if multicast_route:
                host.run("ip route add 224.0.0.0/4 dev eth0")
            host.sysctl(sysctls or {})
            with host.network():
                no_transmit_checksum("eth0")
            self.hub.run(f"ip link set port{number} up")
            if impair and name in impair:
                self.hub.run(f"ip link add in{number} type veth peer name out{number}")
                for end in ("in", "out"):
                    self.hub.run(f"ip link set {end}{number} up")
                self.hub.run(f"ip link set out{number} master br0")
                # frames of port<n> and of in<n> are carried to the other by the program
                self.links[name] = Link(self.hub, program, (f"port{number}", f"in{number}"),
                                        impair[name])
            else:
                self.hub.run(f"ip link set port{number} master br0")

    def __getitem__(self, name):
        return self.hosts[name]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.counts = {name: link.close() for name, link in self.links.items()}
        for host in [*self.hosts.values(), self.hub]:
            host.close()


def lone_host(mounts=False):
    """One machine without a network: multicast on its loopback, as on a robot of one computer."""
    host = Host("robot", mounts)
    host.run("ip link set lo multicast on")
    host.run("ip route add 224.0.0.0/4 dev lo")
    return host


def in_thread(function, *arguments):
    thread = threading.Thread(target=function, args=arguments, daemon=True)
    thread.start()
    return thread

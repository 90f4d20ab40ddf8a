# SPDX-License-Identifier: BSD-3-Clause
"""live_end.py BUILD CONFIG LOG: sends the last MAP and MAP_WAYS of a log to an orchard-viewer, as
lcm-logplayer would, and prints what its page is told then: {"numbers": {id: [row,
position]}, "rows": ..., "ways": ...}.
Runs in a network namespace of its own (in_namespace.sh)."""
import http.client
import json
import os
import signal
import socket
import struct
import subprocess
import sys
import threading
import time

BUILD, CONFIG, LOG = sys.argv[1:4]
GROUP = ("239.255.76.67", 7667)
PORT = 8420
SECONDS = 60


def last_messages():
    """(channel, bytes) of the messages with the time of the last MAP, which begin with that time."""
    sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
    from lcm_log import events
    all_of_map = [(c, d) for c, d in events(LOG) if c in ("MAP", "MAP_WAYS")]
    utime = [d[8:16] for c, d in all_of_map if c == "MAP"][-1]  # after the type's fingerprint
    return [(c, d) for c, d in all_of_map if d[8:16] == utime]


def send_until(is_done):
    """Sends them again and again: a datagram may be lost, and repeated ones change nothing."""
    out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
    messages, number = last_messages(), 0
    while not is_done.wait(1.0):
        for channel, data in messages:
            out.sendto(struct.pack(">II", 0x4C433032, number) + channel.encode() + b"\0" + data, GROUP)
            number += 1


def main():
    viewer = subprocess.Popen([BUILD + "/bin/orchard-viewer", "--config", CONFIG],
                              stderr=subprocess.PIPE, text=True)
    is_done = threading.Event()
    try:
        for line in viewer.stderr:
            if "the page is at" in line:
                break
        threading.Thread(target=viewer.stderr.read, daemon=True).start()
        threading.Thread(target=send_until, args=(is_done,), daemon=True).start()
        stream = http.client.HTTPConnection("127.0.0.1", PORT, timeout=SECONDS)
        stream.request("GET", "/api/stream")
        numbers, end = {}, time.monotonic() + SECONDS
        for line in stream.getresponse():
            if time.monotonic() > end:
                sys.exit("the page was not told of the finished map")
            if not line.startswith(b"data:"):
                continue
            event = json.loads(line[5:])
            if event.get("kind") == "map":
                told = event["landmarks"]
                numbers.update(zip(told["id"], zip(told["row"], told["position"])))
            if event.get("kind") == "rows" and event["ways"] and numbers:
                print(json.dumps({"numbers": numbers, "rows": event["rows"], "ways": event["ways"]}))
                return
    finally:
        is_done.set()
        viewer.send_signal(signal.SIGINT)
        viewer.wait(30)


main()

# SPDX-License-Identifier: BSD-3-Clause
"""look_on.py ADDRESS:PORT NUMBER: as many event streams of a viewer as NUMBER, each read as it comes, until it is ended; a stream
that ends begins anew. It takes only the processor time that nobody else wants: who looks on sits at another machine. Prints a
line when all have begun."""

import os
import selectors
import socket
import sys
import time


def stream(host, port):
    while True:
        try:
            client = socket.create_connection((host, port), timeout=5)
            client.sendall(f"GET /api/stream HTTP/1.1\r\nHost: {host}:{port}\r\n\r\n".encode())
            return client
        except OSError:  # it has not begun to listen
            time.sleep(0.05)


def main():
    os.nice(19)
    host, port = sys.argv[1].rsplit(":", 1)
    waiting = selectors.DefaultSelector()
    for _ in range(int(sys.argv[2])):
        waiting.register(stream(host, int(port)), selectors.EVENT_READ)
    print("all look on", flush=True)
    while True:
        for key, _ in waiting.select():
            try:
                is_there = key.fileobj.recv(65536) != b""
            except OSError:
                is_there = False
            if not is_there:
                waiting.unregister(key.fileobj)
                key.fileobj.close()
                waiting.register(stream(host, int(port)), selectors.EVENT_READ)


main()

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""live_page_test.py BIN RIG: a drive watched in a browser while it goes, by many at once, by some that
never read and by some that mean ill: they see what there is, and the map is as without them."""

import http.client
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

import browser

NUM_REQUESTS = 10000
NUM_DEAF = 8
NUM_READING = 20  # with the deaf and a browser as many as may look on, but three
RESIDENT_MOST_KB = 100 * 1024


def ask(port, path, method="GET", host=None, headers=None, address="127.0.0.1"):
    connection = http.client.HTTPConnection(address, port, timeout=20)
    connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
    connection.putheader("Host", host or f"{address}:{port}")
    for name, value in (headers or {}).items():
        connection.putheader(name, value)
    connection.endheaders()
    answer = connection.getresponse()
    if "stream" in path and answer.status == 200:
        body = b""
    else:
        body = answer.read()
    connection.close()
    return answer.status, body, answer.headers


def resident_kb(pid):
    with open(f"/proc/{pid}/status", encoding="ascii") as file:
        return int(re.search(r"VmHWM:\s+(\d+)", file.read()).group(1))


def reading_clients(port):
    """A process with as many streams that are read; all have begun."""
    script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "benchmark", "look_on.py")
    process = subprocess.Popen([sys.executable, "-B", script, f"127.0.0.1:{port}", str(NUM_READING)], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "all look on\n"
    return process


def pid_of(parent, name):
    found = subprocess.run(["pgrep", "-P", str(parent), "-f", name], capture_output=True, text=True, check=False)
    return int(found.stdout.split()[0])


def check_strangers(port):
    assert ask(port, "/")[0] == 200
    for path in ("/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/api/../../etc/passwd", "/api", "/map.csv", "//",
                 "/api/picture/../stream2"):
        status, body, _ = ask(port, path)
        assert status in (400, 403, 404) and b"root:" not in body, (path, status)
    for method in ("POST", "PUT", "DELETE", "OPTIONS", "PATCH"):
        assert ask(port, "/", method)[0] in (400, 403, 405), method
    assert ask(port, "/", host="evil.example:80")[0] == 403, "a page elsewhere could read this one"
    headers = ask(port, "/")[2]
    assert "default-src 'none'" in headers["Content-Security-Policy"]
    with socket.create_connection(("127.0.0.1", port)) as odd:
        odd.sendall(b"\x00\xff" * 5000 + b"\r\n\r\n")
    print("ok: strangers are turned away")


def deaf_client(port):
    """Asks for the stream and never reads it."""
    client = socket.socket()
    client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    client.connect(("127.0.0.1", port))
    client.sendall(f"GET /api/stream HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())
    return client


def check_token(bin_folder, rig, folder):
    """Other hosts are let in with the token alone."""
    token_file = os.path.join(folder, "token")
    with open(token_file, "w", encoding="ascii") as file:
        file.write("correct-horse-battery\n")
    viewer = os.path.join(bin_folder, "orchard-viewer")
    refused = subprocess.run([viewer, "--config", rig, "--listen", "0.0.0.0:8600"], capture_output=True, text=True,
                             timeout=30, check=False)
    assert refused.returncode == 1 and "--token-file" in refused.stderr, refused
    process = subprocess.Popen([viewer, "--config", rig, "--listen", "0.0.0.0:8600", "--token-file", token_file],
                               stderr=subprocess.PIPE, text=True)
    try:
        for line in process.stderr:
            if "the page is at" in line:
                break
        for path in ("/", "/?token=wrong", "/?token=", "/api/stream?token=correct-horse-batterz", "/api/picture"):
            assert ask(8600, path)[0] == 403, path
        status, _, headers = ask(8600, "/?token=correct-horse-battery")
        assert status == 200
        cookie = headers["Set-Cookie"].split(";")[0]
        assert ask(8600, "/", headers={"Cookie": cookie})[0] == 200
        assert ask(8600, "/", headers={"Cookie": cookie + "x"})[0] == 403
    finally:
        process.send_signal(signal.SIGINT)
        assert process.wait(20) == 0
    print("ok: the token")


def check_page(page, port):
    page.open(f"http://127.0.0.1:{port}/")
    page.wait("return orchardApp.model.count > 3", "the growing map", 90)
    page.wait("return orchardApp.live.pose !== null && orchardApp.live.scan.length > 20", "robot and scan")
    page.wait("return !document.getElementById('look').hidden", "the camera's picture")
    names = page.wait("""
        const text = document.getElementById('processes').innerText;
        return ['viewer', 'detector', 'pose', 'mapper'].every((name) => text.includes(name)) ? text : ''""",
        "every process's state")
    assert "Hz" in names
    assert "GB left" in page.run("return document.getElementById('live').innerText")
    page.wait("return orchardApp.model.numberOf(0) === 12 && orchardApp.model.numberOf(1) === 4", "the whole map", 120)
    page.wait("return orchardApp.model.rows.length === 2", "its rows", 60)
    page.wait("return orchardApp.model.at(2, 6) >= 0", "the last tree's number", 60)
    page.type_into("#query", "row 2 tree 6\n")
    page.wait("return orchardApp.selectedId !== null", "a tree by its number")
    assert page.errors() == [], page.errors()
    others = [url for url in page.requests() if not url.startswith(f"http://127.0.0.1:{port}/")]
    assert others == [], others
    print("ok: a browser sees the drive")


def main():
    browser.require_chromium()
    bin_folder, rig = sys.argv[1:]
    orchard = os.path.join(bin_folder, "orchard")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        check_token(bin_folder, rig, folder)
        live = subprocess.Popen([orchard, "live", rig, "--sim", "tubes", "--seed", "5", "--speed", "2", "--out", "map",
                                 "--record", "rec"], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        reading = None
        try:
            for line in live.stderr:
                if found := re.search(r"watch it at http://127.0.0.1:(\d+)/", line):
                    port = int(found.group(1))
                    break
            end = time.monotonic() + 30
            while True:
                try:
                    ask(port, "/")
                    break
                except ConnectionError:
                    assert time.monotonic() < end, "the viewer does not serve"
                    threading.Event().wait(0.05)
            deaf = [deaf_client(port) for _ in range(NUM_DEAF)]
            reading = reading_clients(port)
            check_strangers(port)
            with browser.Browser() as page:
                check_page(page, port)
            # Some read, and go; many ask.
            for k in range(NUM_REQUESTS):
                status = ask(port, "/" if k % 20 else "/api/picture")[0]
                assert status == 200, status
            viewer = pid_of(live.pid, "orchard-viewer")
            size = resident_kb(viewer)
            print(f"the viewer's largest size after {NUM_REQUESTS} requests: {size / 1024:.1f} MB")
            if os.environ.get("ORCHARD_SANITIZED"):
                print("skipped: the limit on memory, as a sanitizer keeps notes of its own")
            else:
                assert size < RESIDENT_MOST_KB, size
            assert reading.poll() is None
            for client in deaf:
                client.close()
        finally:
            if reading:
                reading.kill()
                reading.wait()
            live.send_signal(signal.SIGINT)
            words = live.stderr.read()
            code = live.wait(60)
        assert code == 0, words
        recording = os.path.join("rec", sorted(os.listdir("rec"))[0])
        subprocess.run([orchard, "map", recording, "--config", rig, "--out", "replayed", "--quiet"], check=True)
        with open("map/map.csv", "rb") as a, open("replayed/map.csv", "rb") as b:
            assert a.read() == b.read(), "the map of a watched drive is not that of its recording"
        print("ok: the map is as if nobody had looked on")


main()

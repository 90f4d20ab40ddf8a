# SPDX-License-Identifier: BSD-3-Clause
"""A page that `orchard view` serves."""

import http.client
import json
import os
import re
import signal
import subprocess


class Served:
    """`orchard view` with its page's address, ended by Ctrl-C."""

    def __init__(self, bin_folder, *words):
        self.process = subprocess.Popen([os.path.join(bin_folder, "orchard"), "view", *words], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        found = re.search(r"http://127.0.0.1:(\d+)/", line)
        assert found, (line, self.process.stderr.read())
        self.port = int(found.group(1))
        self.url = found.group(0)

    def ask(self, path, method="GET", body=None, headers=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        connection.request(method, path, body, headers or {})
        answer = connection.getresponse()
        text = answer.read()
        connection.close()
        return answer.status, text

    def edit(self, **edit):
        status, text = self.ask("/api/edit", "POST", json.dumps(edit), {"Content-Type": "application/json"})
        return status, json.loads(text) if text.startswith(b"{") else text

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGINT)
        code = self.process.wait(30)
        assert code == 0, (code, self.process.stderr.read())

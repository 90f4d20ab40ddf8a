# SPDX-License-Identifier: BSD-3-Clause
"""Chromium without a window, driven over WebDriver (W3C) by Debian's chromedriver."""

import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

SKIPPED = 77


class Browser:
    """One browser with one page, in a profile of its own that goes away with it."""

    def __init__(self, width=1280, height=800, dark=False):
        self.profile = tempfile.mkdtemp(prefix="orchard_browser_")
        self.driver = subprocess.Popen(["chromedriver", "--port=0"], stdout=subprocess.PIPE,
                                       stderr=subprocess.DEVNULL, text=True)
        port = None
        for line in self.driver.stdout:
            if "successfully on port " in line:
                port = int(line.rsplit("on port ", 1)[1].strip(" .\n"))
                break
        assert port, "chromedriver did not start"
        self.url = f"http://127.0.0.1:{port}"
        arguments = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                     "--no-first-run", "--disable-background-networking", "--hide-scrollbars",
                     f"--user-data-dir={self.profile}", f"--window-size={width},{height}"]
        if dark:
            arguments.append("--blink-settings=preferredColorScheme=0")
        options = {"args": arguments, "prefs": {"download.default_directory": self.profile}}
        if width < 500:  # narrower than a window can be
            options["mobileEmulation"] = {"deviceMetrics": {"width": width, "height": height, "pixelRatio": 2}}
        wanted = {"capabilities": {"alwaysMatch": {
            "browserName": "chrome", "goog:chromeOptions": options,
            "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"}}}}
        session = self._call("POST", "/session", wanted)
        self.session = "/session/" + session["sessionId"]

    def _call(self, method, path, body=None):
        data = json.dumps(body).encode() if body is not None else None
        request = urllib.request.Request(self.url + path, data=data, method=method,
                                         headers={"Content-Type": "application/json"})
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(error.read().decode()[:2000]) from error

    def open(self, url):
        self._call("POST", self.session + "/url", {"url": url})

    def run(self, script, *arguments):
        """What a script returns that runs in the page."""
        return self._call("POST", self.session + "/execute/sync", {"script": script, "args": list(arguments)})

    def run_async(self, script, *arguments):
        """The same of a script that calls its last argument when it is done."""
        return self._call("POST", self.session + "/execute/async", {"script": script, "args": list(arguments)})

    def wait(self, script, what, seconds=30):
        """Until a script returns something true."""
        end = time.monotonic() + seconds
        while not (value := self.run(script)):
            assert time.monotonic() < end, what + " did not come"
        return value

    def click(self, x, y):
        """A click of the mouse at a place of the page."""
        self._call("POST", self.session + "/actions", {"actions": [{
            "type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"},
            "actions": [{"type": "pointerMove", "x": round(x), "y": round(y)},
                        {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}]}]})

    def drag(self, x, y, dx, dy):
        self._call("POST", self.session + "/actions", {"actions": [{
            "type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"},
            "actions": [{"type": "pointerMove", "x": x, "y": y}, {"type": "pointerDown", "button": 0},
                        {"type": "pointerMove", "duration": 50, "x": x + dx, "y": y + dy},
                        {"type": "pointerUp", "button": 0}]}]})

    def type_into(self, selector, text):
        found = self._call("POST", self.session + "/element", {"using": "css selector", "value": selector})
        path = f"{self.session}/element/{next(iter(found.values()))}"
        self._call("POST", path + "/clear", {})
        self._call("POST", path + "/value", {"text": text})

    def choose_file(self, selector, path):
        """A file in a form, as its dialog gives it."""
        found = self._call("POST", self.session + "/element", {"using": "css selector", "value": selector})
        self._call("POST", f"{self.session}/element/{next(iter(found.values()))}/value", {"text": path})

    def downloaded(self, name, seconds=30):
        """The path of a file that the page saved."""
        path, end = os.path.join(self.profile, name), time.monotonic() + seconds
        while not os.path.exists(path):
            assert time.monotonic() < end, name + " was not saved"
            time.sleep(0.05)
        return path

    def press(self, key):
        """A key, on what has the focus."""
        self._call("POST", self.session + "/actions", {"actions": [{"type": "key", "id": "keys", "actions": [
            {"type": "keyDown", "value": key}, {"type": "keyUp", "value": key}]}]})

    def picture(self, path):
        with open(path, "wb") as file:
            file.write(base64.b64decode(self._call("GET", self.session + "/screenshot")))

    def log(self, kind):
        return self._call("POST", self.session + "/se/log", {"type": kind})

    def errors(self):
        """What the page's console said that is wrong; a refused script is one."""
        return [entry["message"] for entry in self.log("browser") if entry["level"] in ("SEVERE", "WARNING")]

    def requests(self):
        """Every address that the page asked for since the last call."""
        found = []
        for entry in self.log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                found.append(message["params"]["request"]["url"])
        return [url for url in found if not url.startswith(("chrome:", "chrome-untrusted:", "data:"))]

    def close(self):
        try:
            self._call("DELETE", self.session)
        except (RuntimeError, OSError):
            pass
        self.driver.terminate()
        self.driver.wait()
        shutil.rmtree(self.profile, ignore_errors=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def require_chromium():
    """Leaves, and says so, where there is no browser to test with."""
    for program in ("chromium", "chromedriver"):
        if not shutil.which(program):
            print(f"skipped: no {program} (apt-get install --no-install-recommends chromium chromium-driver)",
                  file=sys.stderr)
            sys.exit(SKIPPED)
    os.environ.setdefault("XDG_CONFIG_HOME", tempfile.gettempdir())

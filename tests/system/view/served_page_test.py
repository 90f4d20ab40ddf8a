#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""served_page_test.py BIN RIG [PICTURES]: `orchard view` of a log and of a map folder in a browser: the slider, steps
and play; corrections by two people at once, with undo; at the width of a desk and of a telephone. PICTURES: a folder for
pictures of what the browser showed."""

import gzip
import json
import os
import pwd
import socket
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import browser  # noqa: E402
from maps import rows_of  # noqa: E402
from served import Served  # noqa: E402

NASTY = "<img src=x onerror='document.title=1'>"


def keep_picture(page, name):
    if len(sys.argv) > 3:
        page.picture(os.path.join(sys.argv[3], name + ".png"))


def fits_the_page(page):
    assert page.run("return document.documentElement.scrollWidth <= innerWidth")
    outside = page.run("""return [...document.querySelectorAll('.card:not([hidden])')].filter((card) => {
        const box = card.getBoundingClientRect();
        return box.left < 0 || box.right > innerWidth || box.top < 0 || box.bottom > innerHeight + 1; }).map((card) => card.id)""")
    assert outside == [], outside


def check_log(page, served, log_info, truth, width):
    page.open(served.url)
    page.wait("return orchardApp.drive.isDone", "the mapped log", 120)
    num_steps = page.run("return orchardApp.drive.numSteps")
    assert num_steps == log_info, (num_steps, log_info)

    # The last step is the finished map.
    page.run("orchardApp.drive.show(1e9)")
    shown = page.run("""const c = orchardApp.model.columns; return c.id.map((id, i) => [id, c.x[i], c.y[i], c.label[i]])""")
    assert sorted(i[0] for i in shown) == sorted(int(row["id"]) for row in truth), shown
    for number, x, y, label in shown:
        row = next(r for r in truth if int(r["id"]) == number)
        assert abs(x - float(row["x_m"])) < 0.001 and abs(y - float(row["y_m"])) < 0.001, (row, x, y)
        assert ["tree", "object", "unseen"][label] == row["class"], row
    assert page.run("return orchardApp.model.rows.length") == len({r["row"] for r in truth if r["row"]})

    # Backwards and forwards, by slider, keys and buttons: the map grows with time, and is the same whichever way one came.
    counts = []
    for step in range(num_steps):
        page.run("const s = document.getElementById('slider'); s.value = arguments[0]; s.dispatchEvent(new Event('input'))", step)
        counts.append(page.run("return orchardApp.model.count"))
    assert counts[0] < counts[-1] and counts[-1] == len(truth), counts
    page.run("orchardApp.drive.show(arguments[0])", num_steps // 2)
    assert page.run("return orchardApp.model.count") == counts[num_steps // 2]
    page.run("document.getElementById('step-back').click()")
    assert page.run("return orchardApp.drive.step") == num_steps // 2 - 1
    assert page.run("return orchardApp.model.count") == counts[num_steps // 2 - 1]
    page.run("document.dispatchEvent(new KeyboardEvent('keydown', {key: '.', bubbles: true}))")
    assert page.run("return orchardApp.drive.step") == num_steps // 2

    # The scan of the step shown, where the robot stood then: near it, and with returns.
    page.wait("return orchardApp.drive.pointsStep === orchardApp.drive.step && orchardApp.drive.points.length > 10", "the scan")
    page.wait("return !document.getElementById('look').hidden", "the picture")
    assert "tree" in page.run("return document.getElementById('confidences').innerText")
    keep_picture(page, f"log_{width}")

    # Play goes on to the end by itself, and stops there.
    page.run("""document.getElementById('speed').value = '30'; orchardApp.drive.show(0);
        document.getElementById('play').click()""")
    page.wait("return orchardApp.drive.step === orchardApp.drive.numSteps - 1 && !orchardApp.drive.player.isPlaying",
              "the end of the drive", 60)
    fits_the_page(page)
    assert page.errors() == [], page.errors()
    others = [url for url in page.requests() if not url.startswith(served.url)]
    assert others == [], others
    status, _ = served.edit(what="undo")
    assert status == 405, "a log is edited"
    # A page of another server at this address is told to begin anew.
    boot = page.run("return orchardApp.data.boot")
    for name in ("drive?steps=0", "step?at=0"):
        assert served.ask(f"/api/{name}&boot={boot}")[0] == 200 and served.ask(f"/api/{name}&boot={boot}1")[0] == 409, name


def landmark_count(page, count, what):
    page.wait(f"return orchardApp.model.count === {count}", what)


TAB, ENTER = "\ue004", "\ue007"


def tab_to(page, name):
    """By the key alone, as who has no mouse does it."""
    for _ in range(60):
        page.press(TAB)
        if page.run("return document.activeElement.id") == name:
            # A ring around it, or around the field with its buttons.
            rings = page.run("const e = document.activeElement; return [e, e.parentElement].map("
                             "each => getComputedStyle(each).outlineStyle)")
            assert "solid" in rings, f"nothing shows that {name} has the focus"
            return
    raise AssertionError(f"the key never leads to {name}")


def keyboard_alone(page, other, number, total):
    """A tree is found, deleted and brought back without a mouse."""
    page.run("orchardApp.select(-1); document.activeElement.blur()")
    tab_to(page, "query")
    for key in f"id {number}" + ENTER:
        page.press(key)
    page.wait(f"return orchardApp.selectedId === {number}", "the tree")
    tab_to(page, "edit-delete")
    page.press(ENTER)
    landmark_count(other, total - 1, "the deletion by keyboard")
    page.wait("return !document.getElementById('undo').disabled", "what there is to undo")
    tab_to(page, "undo")
    page.press(ENTER)
    landmark_count(other, total, "the undo by keyboard")


def check_edits(page, other, served, landmarks, width, editing):
    """`other`: a second person's browser on the same map."""
    trees = [row for row in landmarks if row["class"] == "tree"]
    total = len(landmarks)
    for one in (page, other):
        one.open(served.url)
        landmark_count(one, total, "the map")
    assert page.run("return document.getElementById('edit').hidden") is False
    page.run("const who = document.getElementById('who'); who.value = 'Ana'; who.dispatchEvent(new Event('change'))")

    # Deleted here, gone there; undone there, back here.
    first = int(trees[0]["id"])
    page.run("orchardApp.select(orchardApp.model.withId(arguments[0]), true)", first)
    page.wait("return document.querySelector('#details img.photo').naturalWidth > 10", "its photograph")
    page.run("document.getElementById('edit-delete').click()")
    landmark_count(page, total - 1, "the deletion")
    landmark_count(other, total - 1, "the other's deletion")
    other.wait("return !document.getElementById('undo').disabled", "what there is to undo")
    other.run("document.getElementById('undo').click()")
    landmark_count(page, total, "the undo")
    page.wait("return !document.getElementById('redo').disabled", "what there is to redo")
    page.run("document.getElementById('redo').click()")
    landmark_count(other, total - 1, "the redo")
    other.run("document.getElementById('undo').click()")
    landmark_count(page, total, "the second undo")
    keyboard_alone(page, other, first, total)

    # A tree added by a click on the map, half a metre off the last one's row.
    x, y = float(trees[-1]["x_m"]) + 1.3, float(trees[-1]["y_m"]) + 1.1
    page.run("document.getElementById('add').click()")
    place = page.run("""const app = orchardApp; app.select(-1); app.goTo(...arguments); app.paintNow();
        return [app.view.toScreenX(arguments[0]), app.view.toScreenY(arguments[1])]""", x, y)
    page.click(*place)
    landmark_count(page, total + 1, "the new tree")
    landmark_count(other, total + 1, "the other's new tree")
    new = page.run("""const c = orchardApp.model.columns, i = c.id.indexOf(Math.max(...c.id)); return [c.id[i], c.x[i], c.y[i]]""")
    assert abs(new[1] - x) < 0.05 and abs(new[2] - y) < 0.05, (new, x, y)

    # Class, note, number, name of a row: by the buttons and forms that people use. What is written is never executed.
    page.run("orchardApp.select(orchardApp.model.withId(arguments[0]), true)", first)
    page.run("document.getElementById('edit-class').click()")
    other.wait(f"return orchardApp.model.columns.label[orchardApp.model.withId({first})] === 1", "the class")
    page.run("document.getElementById('edit-note').click()")
    page.type_into("#edit-form input", NASTY + "\n")
    page.wait("return document.getElementById('details').innerText.includes('onerror')", "the note, as text")
    keep_picture(page, f"edit_{width}")
    page.run("orchardApp.editor.renameRow(orchardApp.model.rows[0])")
    page.type_into("#edit-form input", NASTY + "\n")
    other.wait("return document.getElementById('rows').textContent.includes('onerror')", "the row's name")
    second = int(trees[1]["id"])
    page.run("orchardApp.select(orchardApp.model.withId(arguments[0]), true)", second)
    page.run("document.getElementById('edit-renumber').click()")
    page.run("document.querySelector('#edit-form [name=row]').value = '9'")
    page.type_into("#edit-form [name=position]", "7\n")
    other.wait("return orchardApp.model.at(9, 7) >= 0", "the number")

    # Two are one; one is two.
    page.run("orchardApp.editor.send({what: 'merge', trees: [String(arguments[0]), String(arguments[1])]})", new[0], second)
    landmark_count(other, total, "the merged ones")
    page.run("""orchardApp.editor.send({what: 'split', trees: [String(arguments[0])],
        places_m: [[arguments[1] - 0.4, arguments[2]], [arguments[1] + 0.4, arguments[2]]]})""", new[0], x, y)
    landmark_count(other, total + 1, "the split ones")

    # What contradicts the map is said, and nothing happens.
    page.run("orchardApp.editor.send({what: 'delete', trees: ['99999']})")
    page.wait("return document.getElementById('edit-status').textContent.includes('99999')", "why not")
    fits_the_page(page)
    for one in (page, other):
        assert one.run("return document.title") != "1", "a note was executed"
        assert [e for e in one.errors() if "409" not in e] == [], one.errors()
    who = {json.loads(line)["who"] for line in open(editing, encoding="utf-8")}
    assert who == {"Ana", pwd.getpwuid(os.geteuid()).pw_name}, who  # the page suggests the account's


def check_lost_server(bin_folder):
    """The page of a log whose server has ended is grey and says so, until one is back at its address."""
    is_gone = "return document.body.classList.contains('stale') && !document.getElementById('gone').hidden"
    is_there = "return window.orchardApp && orchardApp.drive.isDone && document.getElementById('gone').hidden"
    with browser.Browser() as page:
        with Served(bin_folder, "drive.lcm") as served:
            page.open(served.url)
            page.wait(is_there, "the mapped log", 120)
        page.wait(is_gone, "that the server is gone")
        assert "grayscale" in page.run("return getComputedStyle(document.getElementById('live')).filter")
        page.run("window.isOldPage = true")
        with Served(bin_folder, "drive.lcm", "--listen", f"127.0.0.1:{served.port}"):
            page.wait(is_there + " && !window.isOldPage", "the other server's drive", 120)
            assert page.run("return orchardApp.drive.numSteps") > 0
    print("ok: the log whose server has gone")


def smuggle_an_edit(served):
    """A request within the body of a refused one, as another site's page can send it."""
    add = json.dumps({"what": "add", "places_m": [[50, 50]]})
    inner = (f"POST /api/edit HTTP/1.1\r\nHost: 127.0.0.1:{served.port}\r\nContent-Type: application/json\r\n"
             f"Content-Length: {len(add)}\r\n\r\n{add}").encode()
    # with the head in one piece and padded so that the body begins where the server reads again
    head = (f"POST /api/edit HTTP/1.1\r\nHost: 127.0.0.1:{served.port}\r\nOrigin: http://evil.example\r\n"
            f"Content-Type: text/plain\r\nContent-Length: {len(inner)}\r\nX-Padding: ").encode()
    head += b"x" * (4096 - len(head) - 4) + b"\r\n\r\n"
    with socket.create_connection(("127.0.0.1", served.port), timeout=10) as wire:
        wire.sendall(head + inner)
        answer = b""
        try:
            while True:
                piece = wire.recv(65536)
                if not piece:
                    break
                answer += piece
        except OSError:
            pass  # reset by a server that has closed
    assert answer.count(b"HTTP/1.1 ") <= 1 and b" 200 " not in answer, answer


def check_refusals(bin_folder, folder):
    """Without --edit nothing is kept; with it, nothing from elsewhere."""
    corrections = folder + "/corrections.jsonl"
    with Served(bin_folder, folder) as served:
        assert served.edit(what="undo")[0] == 405
        assert b'"can_edit":false' in served.ask("/")[1]
        for path in ("/api/photo?id=../map.csv", "/api/photo?id=999999", "/api/photo?id=1%2f..%2f..", "/api/photo", "/album/1.jpg",
                     "/../map.csv", "/api/map", "/corrections.jsonl"):
            assert served.ask(path)[0] in (400, 403, 404), path
    assert not os.path.exists(corrections)
    with Served(bin_folder, folder, "--edit") as served:
        plain = json.dumps({"what": "undo"})
        assert served.ask("/api/edit", "POST", plain, {"Content-Type": "text/plain"})[0] == 403
        assert served.ask("/api/edit", "POST", plain, {"Content-Type": "application/json", "Origin": "http://evil.example"})[0] == 403
        assert served.ask("/api/edit", "POST", "[" * 5000, {"Content-Type": "application/json"})[0] == 400
        assert served.ask("/api/edit", "POST", "x" * 100000, {"Content-Type": "application/json"})[0] in (400, 413)
        packed = {"Content-Type": "application/json", "Content-Encoding": "gzip"}
        assert served.ask("/api/edit", "POST", gzip.compress(plain.encode()), packed)[0] == 415
        for bad in ({}, {"what": "sing"}, {"what": "delete"}, {"what": "move", "trees": ["1"], "places_m": [["a", 2]]},
                    {"what": "add", "places_m": [[1e300, 0]]}, {"what": "note", "trees": ["1"], "note": "a\nb"},
                    {"what": "note", "trees": ["1"], "note": "x" * 5000}, {"what": "undo", "of": -1}, {"what": "class", "trees": [1]}):
            assert served.edit(**bad)[0] in (400, 409), bad
        smuggle_an_edit(served)
    assert not os.path.exists(corrections)
    print("ok: refusals")


def main():
    browser.require_chromium()
    bin_folder, rig = sys.argv[1:3]
    orchard = os.path.join(bin_folder, "orchard")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        subprocess.run([orchard, "simulate", "--scene", "tubes", "--seed", "3", "--config", rig, "--out", "drive.lcm"],
                       check=True, stdout=subprocess.DEVNULL)
        subprocess.run([orchard, "map", "drive.lcm", "--out", "map", "--quiet"], check=True)
        landmarks = rows_of("map/map.csv")
        info = subprocess.run([orchard, "log", "info", "drive.lcm", "--json"], check=True, capture_output=True, text=True)
        num_scans = next(c["num_messages"] for c in json.loads(info.stdout)["channels"] if c["channel"] == "SCAN")
        check_refusals(bin_folder, "map")
        check_lost_server(bin_folder)
        for width, height in ((1280, 800), (390, 844)):
            with browser.Browser(width, height) as page:
                with Served(bin_folder, "drive.lcm") as served:
                    check_log(page, served, num_scans, landmarks, width)
                    page.open("about:blank")  # its console would tell that the server has gone
                print(f"ok: the log, {width} pixels wide")
                with browser.Browser() as other, Served(bin_folder, "map", "--edit") as served:
                    check_edits(page, other, served, landmarks, width, "map/corrections.jsonl")
                os.remove("map/corrections.jsonl")
                print(f"ok: edits, {width} pixels wide")
        assert rows_of("map/map.csv") == landmarks, "the map of the run was changed"


main()

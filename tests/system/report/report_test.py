#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""report_test.py BIN RIG: the numbers of `orchard report` are those of map.csv, counted here anew."""

import csv
import html
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from maps import landmark as tree_line, rows_of, write_map  # noqa: E402


def orchard(bin_folder, *arguments, code=0):
    result = subprocess.run([os.path.join(bin_folder, "orchard"), *arguments], capture_output=True, text=True)
    assert result.returncode == code, (arguments, result.returncode, result.stderr)
    return result


def bytes_of(path):
    with open(path, "rb") as file:
        return file.read()


def area_cm2(width_m):
    return math.pi * (100 * float(width_m)) ** 2 / 4


def expected(landmarks):
    """By row as text: trees, numbers of empty places, area; of all rows together under "all", of trunks in none under
    "other_trunks"."""
    result = {}
    for l in landmarks:
        if l["class"] == "tree":
            result.setdefault(l["row"] or "other_trunks", []).append(l)
    table = {}
    for row, trees in result.items():
        numbers = {int(t["position"]) for t in trees if t["position"]}
        empty = [k for k in range(min(numbers), max(numbers)) if k not in numbers] if numbers else []
        table[row] = (len(trees), empty, sum(area_cm2(t["width_m"]) for t in trees))
    rows = [t for row, t in table.items() if row != "other_trunks"]
    table["all"] = (sum(t[0] for t in rows), sum(len(t[1]) for t in rows), sum(t[2] for t in rows))
    return table


def check_csv(path, landmarks, names=None):
    """`names`: numbers of rows by their names."""
    table = {(names or {}).get(row["row"], row["row"]): row for row in rows_of(path)}
    truth = expected(landmarks)
    assert set(table) == set(truth), (set(table), set(truth))
    for row, (num_trees, empty, area) in truth.items():
        said = table[row]
        assert int(said["trees"]) == num_trees, (row, said)
        assert abs(float(said["tcsa_cm2"]) - area) < 0.05 + 1e-4 * area, (row, said, area)
        if row == "all":
            assert int(said["empty_places"]) == empty, (said, empty)
        else:
            assert said["empty_positions"].split() == [str(k) for k in empty], (row, said, empty)
    return table, truth


def page_text(path):
    page = bytes_of(path).decode("utf-8")
    assert "<script" not in page and "http" not in re.sub(r"http-equiv|xmlns(:xlink)?=\"http[^\"]*\"", "", page)
    return html.unescape(re.sub(r"<[^>]*>", " ", re.sub(r"(?s)<(svg|style).*?</\1>", "", page)))


def letters_of_the_block(folder):
    """Of the report's last drawing."""
    page = bytes_of(os.path.join(folder, "report.html")).decode("utf-8")
    return re.findall(r"(?s)<figure>.*?</figure>", page)[-1].count("<use")


def check_print(page, path, truth):
    """What a browser prints, read by poppler: the counts, and each row's trees, empty places and area."""
    if not shutil.which("pdftotext") or not shutil.which("chromium"):
        print("no pdftotext (poppler-utils) or chromium: the printed page is not read")
        return
    subprocess.run(["chromium", "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                    "--user-data-dir=" + path + ".profile", "--no-pdf-header-footer", "--print-to-pdf=" + path,
                    "file://" + page], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    text = subprocess.run(["pdftotext", "-layout", path, "-"], capture_output=True, text=True, check=True).stdout
    rows = [row for row in truth if row not in ("all", "other_trunks")]
    assert f"Trees in rows: {truth['all'][0]}; rows: {len(rows)}." in " ".join(text.split()), text
    for row in rows:
        num_trees, empty, area = truth[row]
        lines = [line.split() for line in text.splitlines() if line.split()[:1] == [row]]
        assert any(str(num_trees) in line[1:] and any(
            re.fullmatch(r"[0-9]+", word) and abs(int(word) - area) < 0.6 for word in line[1:]) for line in lines), (row, area, lines)
        assert not empty or any(str(k) in " ".join(line) for k in empty for line in lines), (row, empty, lines)


def main(bin_folder, rig, folder):
    log, here = os.path.join(folder, "drive.lcm"), os.path.join(folder, "autumn")
    orchard(bin_folder, "simulate", "--scene", "orchard", "--seed", "7", "--config", rig, "--out", log)
    orchard(bin_folder, "map", log, "--config", rig, "--out", here, "--no-derived")
    landmarks = rows_of(os.path.join(here, "map.csv"))

    orchard(bin_folder, "report", here)
    out = os.path.join(here, "report")
    table, truth = check_csv(os.path.join(out, "report.csv"), landmarks)
    text = page_text(os.path.join(out, "report.html"))
    num_rows = len([row for row in truth if row not in ("all", "other_trunks")])
    in_rows = truth["all"][0]
    for sentence in (f"Trees in rows: {in_rows}; rows: {num_rows}.",
                     f"Empty places between the trees of the rows: {truth['all'][1]}.", "Driven on 2013-12-02",
                     f"{truth['all'][2]:.0f} cm²", "in the view of the camera"):
        assert sentence in text, (sentence, text)
    assert " roc" not in text and "probability" not in text
    check_print(os.path.join(out, "report.html"), os.path.join(folder, "printed.pdf"), truth)

    # The block's picture has each tree's number: so many more letters than that of the same map without rows.
    bare = os.path.join(folder, "bare")
    os.makedirs(bare)
    with open(os.path.join(bare, "map.csv"), "w", newline="") as file:
        writer = csv.DictWriter(file, landmarks[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows({**landmark, "row": "", "position": ""} for landmark in landmarks)
    orchard(bin_folder, "report", bare)
    numbered, plain = (letters_of_the_block(path) for path in (out, os.path.join(bare, "report")))
    assert numbered - plain >= in_rows > 20, (numbered, plain, in_rows)

    # On a plane of 5 % and 8 % every row is as steep as its line, from its first tree to its last; one height is unknown.
    sloping = os.path.join(folder, "sloping")
    os.makedirs(sloping)
    with open(os.path.join(sloping, "map.csv"), "w", newline="") as file:
        writer = csv.DictWriter(file, landmarks[0].keys(), lineterminator="\n")
        writer.writeheader()
        for k, landmark in enumerate(landmarks):
            z_m = 0.05 * float(landmark["x_m"]) + 0.08 * float(landmark["y_m"])
            writer.writerow({**landmark, "z_m": f"{z_m:.4f}" if k else "", "z_sd_m": "0.05" if k else ""})
    told = json.loads(orchard(bin_folder, "report", sloping, "--json").stdout)
    for row in told["rows"]:
        if row["row"] in ("all", "other_trunks"):
            assert row["slope_percent"] is None, row
            continue
        trees = sorted((int(l["position"]), float(l["x_m"]), float(l["y_m"])) for l in landmarks
                       if l["class"] == "tree" and l["row"] == str(row["row"]) and l["position"])
        dx, dy = trees[-1][1] - trees[0][1], trees[-1][2] - trees[0][2]
        assert abs(row["slope_percent"] - 100 * (0.05 * dx + 0.08 * dy) / math.hypot(dx, dy)) < 0.2, row
        assert 0 < row["slope_sd_percent"] < 2, row
    assert "How steep the rows are" in page_text(os.path.join(sloping, "report", "report.html"))
    assert "How steep" not in text or landmarks[0]["z_m"], text

    # For machines: the table again.
    told = json.loads(orchard(bin_folder, "report", here, "--json").stdout)
    assert told["files"] == ["report.html", "report.csv"] and os.path.samefile(told["folder"], out), told
    assert len(told["rows"]) == len(table), told
    for row in told["rows"]:
        assert set(row) == set(table[str(row["row"])]), row
        for name, cell in table[str(row["row"])].items():
            if name == "empty_positions":
                assert row[name] == [int(k) for k in cell.split()], row
            else:
                assert str(row[name]) == cell if name == "row" else row[name] == (float(cell) if cell else None), (name, row)

    # The same map, the same bytes; other words, the same numbers.
    again, spanish = os.path.join(folder, "again"), os.path.join(folder, "informe")
    orchard(bin_folder, "report", here, "--out", again)
    for name in ("report.html", "report.csv"):
        assert bytes_of(os.path.join(out, name)) == bytes_of(os.path.join(again, name)), name
    orchard(bin_folder, "report", os.path.join(here, "map.csv"), "--out", spanish, "--language", "es")
    assert bytes_of(os.path.join(out, "report.csv")) == bytes_of(os.path.join(spanish, "report.csv"))
    text = page_text(os.path.join(spanish, "report.html"))
    assert f"Árboles en filas: {in_rows}; filas: {num_rows}." in text and "marras" in text, text

    # An earlier map with thinner trunks and one tree more.
    before = os.path.join(folder, "spring")
    shutil.copytree(here, before)
    earlier = [dict(row, width_m=f"{float(row['width_m']) / 1.05:.4f}") for row in landmarks]
    with open(os.path.join(before, "map.csv"), "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, landmarks[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(earlier)
    orchard(bin_folder, "report", here, "--previous", before, "--out", again)
    grown = {row["row"]: row for row in rows_of(os.path.join(again, "report.csv"))}
    for row, (num_trees, _, area) in truth.items():
        was = sum(area_cm2(l["width_m"]) for l in earlier
                  if l["class"] == "tree" and (bool(l["row"]) if row == "all" else (l["row"] or "other_trunks") == row))
        assert int(grown[row]["measured_twice"]) == num_trees, grown[row]
        assert abs(float(grown[row]["tcsa_growth_cm2"]) - (area - was)) < 0.1, (grown[row], area - was)
        assert abs(float(grown[row]["tcsa_growth_percent"]) - 100 * (area / was - 1)) < 0.02, grown[row]
    assert "Compared with spring of 2013-12-02" in page_text(os.path.join(again, "report.html"))

    # What people corrected counts; --as-mapped is the map of the run.
    tree = next(l for l in landmarks if l["class"] == "tree" and l["row"])
    orchard(bin_folder, "edit", "class", here, tree["id"], "object")
    orchard(bin_folder, "edit", "row", here, tree["row"], "by the road")
    orchard(bin_folder, "report", here, "--out", again)
    check_csv(os.path.join(again, "report.csv"),
              [dict(l, **({"class": "object", "row": "", "position": ""} if l is tree else {})) for l in landmarks],
              {"by the road": tree["row"]})
    assert "by the road" in page_text(os.path.join(again, "report.html"))
    orchard(bin_folder, "report", here, "--out", spanish, "--as-mapped")
    assert bytes_of(os.path.join(out, "report.csv")) == bytes_of(os.path.join(spanish, "report.csv"))

    # What cannot be told is refused, with a reason.
    refused = orchard(bin_folder, "report", here, "--previous", os.path.join(before, "map.csv"), "--language", "fr", code=2)
    assert "en" in refused.stderr and "es" in refused.stderr, refused.stderr
    os.remove(os.path.join(before, "trajectory.csv"))
    refused = orchard(bin_folder, "report", here, "--previous", before, "--out", again, code=3)
    assert "trajectory.csv" in refused.stderr, refused.stderr
    # A page of 760 x 860 px has room for 26,144 symbols of 5 px: of one more tree there is no picture, which is said.
    for num in (26144, 26145):
        crowd = write_map(os.path.join(folder, f"crowd_{num}"),
                          [tree_line(k + 1, 2.0 * (k % 200), 4.0 * (k // 200)) for k in range(num)])
        orchard(bin_folder, "report", crowd)
        page = bytes_of(os.path.join(crowd, "report", "report.html"))
        assert (b"No picture: of 26145 trees" in page) == (num > 26144), num
        assert (len(page) < 100_000) == (num > 26144), (num, len(page))
    with open(os.path.join(here, "summary.json"), "w", encoding="utf-8") as file:
        file.write("[1, 2")
    refused = orchard(bin_folder, "report", here, "--out", again, code=3)
    assert "summary.json" in refused.stderr, refused.stderr


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as temporary:
        main(sys.argv[1], sys.argv[2], temporary)
    print("report: as map.csv says")

# SPDX-License-Identifier: BSD-3-Clause
"""The experiments' own work: trial(lab, seeds) returns a figure for each row of its name in catalogue.py."""
import gzip
import json
import math
import os
import random
import re
import subprocess
import sys

from lab import ROOT, Failed, apart, mean, median, overlay, rms, rows_of
from rig_faults import altered_log

sys.path.insert(0, str(ROOT / "tests/system/free_ways"))

LIGHTS = {
    "neutral": {}, "dark": {"simulation.camera_response.exposure_ev": -2.0}, "bright": {"simulation.camera_response.exposure_ev": 2.0},
    "warm": {"simulation.light.temperature_k": 3000.0}, "cold": {"simulation.light.temperature_k": 8000.0},
    "low": {"simulation.light.sun_from_seed": "false", "simulation.light.sun_azimuth_deg": 90.0,
            "simulation.light.sun_elevation_deg": 10.0},
}


def span(values, digits=3):
    return ", ".join(f"{v:.{digits}f}" for v in values)


# the paper's scene

def tubes(lab, seeds):
    scenes = lab.lines("tube_seeds", ROOT / "config/tubes.yaml", seeds[0], seeds[-1])
    return {
        "scenes": f"{sum(not s['complaints'] for s in scenes)} of {len(scenes)}",
        "error": f"{mean(s['rms_mm'] for s in scenes):.1f} mm; {max(s['rms_mm'] for s in scenes):.1f} mm",
        "confidence": f"{mean(s['roc'] for s in scenes):.3f}",
        "standard_errors": f"{mean(s['se_x_mm'] for s in scenes):.1f}, {mean(s['se_y_mm'] for s in scenes):.1f} mm",
    }


# detection in simulated orchards

def hard_drives(lab, seeds, changes, seconds=40):
    """Drives of the hard orchard with their looks, and their maps by the same rig."""
    rig = lab.rig("orchard_hard", changes)

    def one(seed):
        drive = lab.drive(rig, seed, seconds=seconds, looks=True)
        return drive, lab.map(drive, rig, "--quiet")

    pairs = lab.each(seeds, one)
    return [d for d, _ in pairs], [m for _, m in pairs]


def orchard_hard(lab, seeds):
    f1 = {}
    for light, changes in LIGHTS.items():
        lab.say(f"light {light}")
        drives, maps = hard_drives(lab, seeds, changes)
        looks = lab.looks(maps, drives)
        f1[light] = looks["observations"]["f1"]
        if light == "neutral":
            o, marks = looks["observations"], looks["landmarks"]
            slices = [s for s in looks["by_range"] if s["to_m"] <= 4.0]
            figures = {
                "observations": f"{o['precision']:.3f}, {o['recall']:.3f}", "landmarks": f"{marks['f1']:.3f}",
                "centre": f"{1e3 * max(s['centre_error']['rms_m'] for s in slices):.1f} mm",
                "probabilities": f"{looks['probability']['expected_calibration_error']:.3f}, "
                                 f"{marks['probability']['expected_calibration_error']:.3f}"}
    figures["lights"] = f"{max(f1['neutral'] - v for v in f1.values()):.3f}"
    return figures


def fit_drives(lab, num, seconds):
    """Drives of seeds 1001 and up, each in another light, of which models are learnt."""
    lights = list(LIGHTS.values())
    return lab.each(range(num), lambda i: lab.drive(lab.rig("orchard_hard", lights[i % len(lights)]), 1001 + i,
                                                    seconds=seconds, looks=True))


def learn(lab, rig, drives, appearance=True, probability=True, trunks=True):
    """The text of a rig with its models learnt anew."""
    logs = [d / "drive.lcm" for d in drives]
    looks = [d / "looks.csv" for d in drives]
    what = {"rig": rig, "drives": [d.name for d in drives], "how": [appearance, probability, trunks],
            "programs": [lab.digest(p) for p in ("orchard", "learn_appearance", "learn_probability")]}

    def make(folder):
        (folder / "rig.yaml").write_text(rig)
        to = ["--config", folder / "rig.yaml", "--out", folder / "rig.yaml", "--quiet"]
        if trunks:
            lab.orchard("calibrate", "trunks", *logs, "--colour-model", "hue_interval", *to)
        if appearance:
            lab.run("learn_appearance", *logs, "--observations", *looks, "--stride", 1, *to)
        if probability:
            gate = {"detector.appearance.confidence_min": 0.0}  # a look counts by its probability, not by a gate
            (folder / "rig.yaml").write_text(overlay((folder / "rig.yaml").read_text(), gate))
            lab.run("learn_probability", *logs, "--observations", *looks, *to)

    return (lab.made("learnt", what, make) / "rig.yaml").read_text()


def learn_orchard(lab, seeds):
    rig = learn(lab, lab.rig("orchard_hard"), fit_drives(lab, len(seeds), 0))
    path = lab.out / "orchard_hard.yaml"
    path.write_text(rig)
    lab.say(f"learnt anew: {path}")
    return {}


STEPS = [  # each keeps what stands above it
    ("the paper's rules", {
        "detector.decision": "roc", "detector.colour_model": "hue_interval", "detector.visible_fraction_min": 1.0,
        "mapper.evidence": "labels", "detector.width.mode": "paper", "detector.use_odometry": "false",
        "mapper.min_observations": 1, "mapper.merge_m": 0.10, "mapper.deskew_pose_gap_max_s": 0,
        "detector.segmentation.split_touching": "false", "detector.segmentation.min_beams_circle": 1000}, False, False),
    ("compensated width", {"detector.width.mode": "compensated"}, False, False),
    ("segmentation", {"detector.segmentation.split_touching": "true", "detector.segmentation.min_beams_circle": 3,
                      "detector.visible_fraction_min": 0.7}, False, False),
    ("appearance", {}, True, False),
    ("motion", {"detector.use_odometry": "true", "detector.pairing_tolerance_s": 0.1,
                "mapper.deskew_pose_gap_max_s": 0.25}, True, False),
    ("probability", {"detector.decision": "probability", "mapper.evidence": "probability"}, True, True),
    ("landmarks", {"mapper.min_observations": 4, "mapper.merge_m": 0.05}, True, True),
]


def ablation(lab, seeds):
    drives = lab.each(seeds, lambda seed: lab.drive(lab.rig("orchard_hard"), seed, seconds=40, looks=True))
    fits = fit_drives(lab, 6, 40)
    rig, observed, marked = lab.rig("orchard_hard"), [], []
    for name, changes, appearance, probability in STEPS:
        rig = overlay(rig, changes)
        learnt = learn(lab, rig, fits, appearance, probability)
        maps = lab.each(drives, lambda drive, learnt=learnt: lab.map(drive, learnt, "--quiet"))
        looks = lab.looks(maps, drives)
        observed.append(looks["observations"]["f1"])
        marked.append(looks["landmarks"]["f1"])
        lab.say(f"{name}: {observed[-1]:.4f} per observation, {marked[-1]:.4f} per landmark")
    return {"observations": span(observed), "landmarks": span(marked)}


def moving_robot(lab, seeds):
    rig = ROOT / "config/orchard.yaml"
    runs = lab.lines("moving_robot_seeds", rig, "map", seeds[0], seeds[-1])
    delays = lab.lines("moving_robot_seeds", rig, "delay", seeds[0], seeds[-1])

    def error_mm(variant):
        of = [r for r in runs if r["variant"] == variant]
        return 1e3 * math.sqrt(sum(r["num"] * r["rms_m"] ** 2 for r in of) / sum(r["num"] for r in of))

    still = error_mm("stop and go")
    return {
        "error": f"{error_mm('late'):.1f} mm, {still:.1f} mm",
        "not_undone": f"{error_mm('late, sweep not undone'):.1f} mm",
        "delay": f"{1e3 * max(abs(d['found_s'] - d['delay_s']) for d in delays):.2f} ms",
    }


# camera

def photographs(lab, seeds):
    data = lab.data / "cherry_trunks"
    if not data.is_dir():
        raise Failed(f"there are no photographs in {data}")
    model = lab.out / "cherry.yaml"
    lab.run("evaluate_windows", "--images", data / "images", "--masks", data / "masks", "--only", "000-019", "--out", model)

    def area(ev, *options):
        said = lab.run("evaluate_windows", "--images", data / "images", "--masks", data / "masks", "--model", model, "--only",
                       "020-119", "--exposure", ev, *options)
        return json.loads(said)["auc"]

    evs = lab.each((0, -2, -1, 1, 2), area)
    return {"area": f"{evs[0]:.3f}", "exposures": span(evs[1:])}


APPLE_RIG = """# a depth camera as a laser: noise of z^2 x 0.08 px / (19.5 px m) by the data sheet, at a metre
laser:
  range_sd_m: 0.001
  range_sd_fraction: 0.004
camera:
  width_px: 640
  height_px: 480
  fc_px: [625, 625]
  cc_px: [320, 240]
detector:
  segmentation:
    min_beams: 4
    range_max_m: 3
"""


def apple_trunks(lab, seeds):
    data = lab.data / "apple_trunks"
    if not data.is_dir():
        raise Failed(f"there are no pictures in {data}")
    calipers = [[float(c) for c in line.split(",")[1:4]] for line in (data / "row_96_diameters.csv").read_text().splitlines()[1:]]
    true_m = {f"{i:03}": 1e-3 * mean(c) for i, c in enumerate(calipers, 1) if i > 1}  # the first has its neighbour's line
    taught = {f"{i:03}" for i in range(5, 101, 5)}

    def make(folder):
        (folder / "images").mkdir()
        for picture in (data / "images").iterdir():
            (folder / "images" / picture.name[-7:]).symlink_to(picture)
        with gzip.open(data / "depth_rows.csv.gz", "rt") as rows:
            (folder / "rows.csv").write_text(rows.read().replace("row96_", ""))
    folder = lab.made("apples", {"data": str(data), "pictures": 1}, make)
    masks = lab.out / "apple_masks"
    masks.mkdir(exist_ok=True)

    def looks(rig, *options):
        found = lab.lines("apple_trunks", folder / "rows.csv", folder / "images", lab.rig_file(rig), *options)
        return [{**look, "true_m": true_m[look["picture"]]} for look in found if look["picture"] in true_m]

    def errors(found, key, of_taught):
        """Of each tree, the median over its scans; and of each scan."""
        ratios = {}
        for look in found:
            if (look["picture"] in taught) == of_taught and look[key] > 0:
                ratios.setdefault(look["picture"], []).append(look[key] / look["true_m"] - 1)
        return [median(r) for r in ratios.values()], [e for r in ratios.values() for e in r]

    # the widths of trees and what a single one scatters, from those that teach
    widths = [true_m[i] for i in taught]
    sd_m = math.sqrt(sum((w - mean(widths)) ** 2 for w in widths) / (len(widths) - 1))
    rig = overlay(APPLE_RIG, {"detector.width.mean_m": f"{mean(widths):.4f}", "detector.width.sd_m": f"{sd_m:.4f}"})
    first = [look for look in looks(rig) if look["picture"] in taught]
    scale = median(look["laser_m"] / look["true_m"] for look in first)
    off = [abs(look["laser_m"] - scale * look["true_m"]) * 0.4 / look["laser_sd_m"] for look in first]
    rig = overlay(rig, {"detector.width.sd_per_beam_step": f"{1.4826 * median(off):.2f}"})
    by_sheet = looks(rig, masks)
    focal_px = 625 * (1 + median(errors(by_sheet, "fused_m", True)[0]))
    learnt = overlay(rig, {"camera.fc_px": f"[{focal_px:.1f}, {focal_px:.1f}]"})
    by_trees = looks(learnt)

    def told(found, key):
        trees, scans = errors(found, key, False)
        return f"{100 * median(map(abs, trees)):.1f}, {100 * median(trees):+.1f}, {100 * median(map(abs, scans)):.1f} %"

    def sure(found, key):
        return sum(abs(look[key + "_m"] - look["true_m"]) < 2 * look[key + "_sd_m"] for look in found) / len(found)

    # appearance, learnt from the same trees, or from the first twenty
    def model(numbers):
        path = lab.out / "apple.yaml"
        lab.run("evaluate_windows", "--images", folder / "images", "--masks", masks, "--only", numbers, "--config",
                lab.rig_file(learnt), "--out", path)
        return path

    def area(path, numbers):
        return json.loads(lab.run("evaluate_windows", "--images", folder / "images", "--masks", masks, "--model", path, "--only",
                                  numbers))["auc"]

    first_twenty = area(model("1-20"), "21-100")
    path = model(",".join(sorted(taught)))
    others = ",".join(sorted({f"{i:03}" for i in range(1, 101)} - taught))
    seen = [look for look in looks(path.read_text()) if look["picture"] not in taught]
    trees = {look["picture"] for look in seen if look["tree"]}
    judged = [look for look in seen if look["tree"] and look["picture_m"] > 0]
    return {
        "by_sheet": "; ".join(told(by_sheet, key) for key in ("laser_m", "picture_m", "fused_m")),
        "by_trees": "; ".join(told(by_trees, key) for key in ("laser_m", "picture_m", "fused_m")) + f" (f {focal_px:.0f} px)",
        "within": ", ".join(f"{100 * sure(judged, key):.0f} %" for key in ("laser", "picture", "fused")),
        "area": f"{area(path, others):.3f}",
        "first": f"{first_twenty:.3f}",
        "detector": f"{len(trees)} of {len({look['picture'] for look in seen})}, "
                    + told([look for look in seen if look["tree"]], "width_m"),
    }


# laser

def laser_widths(lab, seeds):
    rows = lab.lines("laser_widths", len(seeds), seeds[0])
    whole = [r for r in rows if r["circle_fitted"] > 0.9]
    return {"across": f"{median(r['circle_across_mm'] / r['angle_across_mm'] for r in whole):.2f} (median of {len(whole)})",
            "widths": f"{max(r['circle_width_mm'] for r in whole if r['range_m'] <= 2):.1f} mm",
            "ellipses": f"{100 * min(r['in_95'] for r in whole):.0f} to {100 * max(r['in_95'] for r in whole):.0f} %"}


def thin_widths(lab, seeds):
    rows = [r for r in lab.lines("thin_widths", len(seeds), seeds[0]) if not r["wall"] and r["range_m"] <= 5]
    return {"bias": f"{100 * max(abs(r['bias_fraction']) for r in rows):.1f} %",
            "spread": f"{median(r['sd_over_bound'] for r in rows):.2f}, {max(r['sd_over_bound'] for r in rows):.2f}"}


def beacons(lab, seeds):
    rows = lab.lines("beacons", len(seeds), seeds[0])
    return {"found": f"{sum(r['found'] for r in rows):.0f} of {15 * len(rows)}",
            "extra": f"{sum(r['extra'] for r in rows):.0f}; {max(r['extra'] for r in rows):.0f}"}


# calibration

def calibration(lab, seeds):
    camera = lab.lines("camera_seeds", seeds[0], seeds[-1])
    mount = lab.lines("laser_camera_seeds", seeds[0], seeds[-1], 20, "edges")
    mount = [m for m in mount if not m["refused"]]
    wrong = [line for stated in (0.80, 0.85, 0.90, 0.95, 1.05, 1.10, 1.15, 1.20)
             for line in lab.lines("laser_camera_seeds", seeds[0], seeds[min(9, len(seeds) - 1)], 20, "edges", stated)]
    named = [w for w in wrong if w["refused"] and w["board_scale"] > 0]
    off = max((abs(w["board_scale"] * w["stated_of_true"] - 1) for w in named), default=math.nan)
    return {"camera": f"{100 * max(max(c['focal_error']) for c in camera):.3f} %, "
                      f"{max(max(c['centre_error_px']) for c in camera):.2f} px",
            "mount": f"{math.degrees(rms(m['turn_rad'] for m in mount)):.3f} degrees, {1e3 * rms(m['shift_m'] for m in mount):.1f} mm",
            "squares": f"{sum(w['refused'] for w in wrong):.0f} of {len(wrong)}; {len(named)}: at most {100 * off:.1f} %"}


def picked_ids(truth, landmarks):
    """Landmarks that a person who knows the trees would pick."""
    picked = set()
    for tree in (t for t in truth if t["class"] == "tree"):
        nearest = min(landmarks, key=lambda mark: apart(mark, tree))
        if apart(nearest, tree) < 0.3:
            picked.add(int(nearest["id"]))
    return sorted(picked)


def calibrate_trunks(lab, seeds):
    rig = lab.rig("orchard_hard", {"detector.probability": None, "detector.appearance": None, "detector.colour": None,
                                   "detector.colour_model": None, "detector.decision": None, "mapper.evidence": None})
    kelvin = (8000.0, 3000.0, 6500.0, 4000.0, 10000.0)

    def one(seed):
        lit = overlay(rig, {"simulation.light.temperature_k": kelvin[(seed - 1) % 5]})
        learnt_from = lab.drive(lit, seed, seconds=40, looks=True)
        judged_on = lab.drive(lit, seed + 100, seconds=40, looks=True)
        first = lab.map(learnt_from, lit, "--quiet")
        figures = []
        for way in ("automatic", "picked"):
            out = lab.out / f"trunks_{seed}_{way}.yaml"
            command = ["calibrate", "trunks", learnt_from / "drive.lcm", "--config", lab.rig_file(lit), "--out", out]
            if way == "picked":
                ids = picked_ids(rows_of(learnt_from / "truth.csv"), rows_of(first / "map.csv"))
                said = lab.orchard(*command, "--map", first, "--ids", ",".join(map(str, ids)), may_fail=True, both=True)
                # landmarks that were never seen in full are named by the first try and left out by the second
                unseen = {int(i) for text in re.findall(r"no complete observation[^:]*: (.*); remove", said)
                          for i in re.findall(r"landmark (\d+)|, (\d+) at", text) for i in i if i}
                command += ["--map", first, "--ids", ",".join(str(i) for i in ids if i not in unseen)]
            lab.orchard(*command)
            looks = lab.looks([lab.map(judged_on, out.read_text(), "--quiet")], [judged_on])
            figures.append((looks["observations"]["f1"], looks["landmarks"]["f1"]))
        return figures

    pairs = lab.each(seeds, one)
    lost = [picked[0] - automatic[0] for automatic, picked in pairs]
    return {"f1": f"{mean(a[0] for a, _ in pairs):.3f}, {mean(p[0] for _, p in pairs):.3f}; "
                  f"{mean(lost):.3f}, {max(lost):.3f}",
            "landmarks": f"{mean(a[1] for a, _ in pairs):.3f}, {mean(p[1] for _, p in pairs):.3f}"}


# pose

def slam_figures(lab, rig, seeds, scene="orchard", seconds=0):
    def one(seed):
        drive = lab.drive(rig, seed, scene, seconds)
        folder = lab.map(drive, rig, "--quiet", "--timing")
        return lab.judged(folder, drive), lab.path(folder, drive / "poses.csv"), folder, drive

    return lab.each(seeds, one)


def block(lab, seeds):
    runs = slam_figures(lab, lab.rig("block"), seeds)
    trees = [1e3 * m["error_trees"]["rms_m"] for m, _, _, _ in runs]
    paths = [1e3 * p["ape_position_m"]["rmse"] for _, p, _, _ in runs]
    return {"trees": f"{mean(trees):.1f} mm; {max(trees):.1f} mm", "path": f"{mean(paths):.1f} mm; {max(paths):.1f} mm",
            "missed": f"{sum(m['num_trees_missed'] for m, _, _, _ in runs)}, {sum(m['num_duplicates'] for m, _, _, _ in runs)}"}


DATUM = {"pose.gnss.datum": "[-27.6040, 151.9320, 690.0]"}


def block_rtk(lab, seeds):
    rig = lab.rig("block", {"simulation.motion.gnss_rate_hz": 5.0, "simulation.motion.gnss_sd_m": 0.02, "pose.slam.use_gnss": "true",
                            **DATUM})
    return {"raw": f"{1e3 * mean(m['error_trees_unaligned']['rms_m'] for m, _, _, _ in slam_figures(lab, rig, seeds)):.1f} mm"}


def two_scanners(lab, seeds):
    half = {"num_beams": 513, "bearing_min_rad": -math.pi / 2, "bearing_step_rad": 0.006135923151542565, "rate_hz": 10.0,
            "beam_period_us": 97.65625}
    one = lab.rig("block", {f"simulation.scanner.{key}": value for key, value in half.items()})
    two = overlay(one, {"laser_rear.enabled": "true", "laser_rear.mount_x_m": -0.35, "laser_rear.mount_yaw_rad": math.pi})
    runs = [slam_figures(lab, rig, seeds, seconds=600) for rig in (one, two)]
    return {"trees": "; ".join(f"{1e3 * mean(m['error_trees']['rms_m'] for m, _, _, _ in r):.1f} mm" for r in runs),
            "path": "; ".join(f"{1e3 * mean(p['ape_position_m']['rmse'] for _, p, _, _ in r):.1f} mm" for r in runs)}


SLOPES_PERCENT = (0, 5, 10, 15, 25)
BUMPS_M3 = {1: 0.00223, 3: 0.0201, 5: 0.0558}  # degrees by which they pitch the body of hills.yaml, one sigma


def held_for_trees(folder, drive, gate_m=0.3):
    """True trees, landmarks held for trees (probability above a half), and how many of these are one of those."""
    def places(rows):
        return [(float(row["x_m"]), float(row["y_m"])) for row in rows if row["class"] == "tree"]

    trees = places(rows_of(drive / "truth.csv"))
    held = places(row for row in rows_of(folder / "map.csv") if float(row["probability"]) > 0.5)
    near = sorted((math.dist(h, t), i, j) for i, h in enumerate(held) for j, t in enumerate(trees) if math.dist(h, t) < gate_m)
    used_held, used_trees = set(), set()
    for _, i, j in near:
        if i not in used_held and j not in used_trees:
            used_held.add(i)
            used_trees.add(j)
    return len(trees), len(held), len(used_trees)


def hill_rig(lab, slope, bumps_m3):
    """Three rows, up and down a hill that is steeper along them than across, as 4 to 3."""
    return lab.rig("hills", {"simulation.orchard.num_rows": 3, "simulation.terrain.slope_along_percent": 0.8 * slope, **DATUM,
                             "simulation.terrain.slope_across_percent": 0.6 * slope, "simulation.terrain.roughness_m3": bumps_m3})


MET = ("tree", "object", "branch", "grass", "ground")


def met_by(lab, rig, seed, extra):
    """Of trees and objects that are nothing of the truth, how many are what most beams met there; the last number: where none met any."""
    extra = [e for e in extra if e["class"] != "unseen"]
    places = [f"{e[axis]}" for e in extra for axis in ("x_m", "y_m")]
    counts = dict.fromkeys((*MET, "nothing"), 0)
    for there in lab.lines("met_at", lab.rig_file(rig), seed, *places) if places else []:
        most = max(MET, key=lambda kind: there[kind])
        counts[most if there[most] else "nothing"] += 1
    return counts


def tilt_errors(lab):
    """A unit's biases hold for a drive, so that only drives tell them; scans of five beams tell when the truth is known."""
    rig = lab.rig(hill_rig(lab, 10, BUMPS_M3[3]), {"simulation.scanner.num_beams": 5, "simulation.scanner.bearing_step_rad": 0.1})

    def one(seed):
        drive = lab.drive(rig, seed)
        return json.loads(lab.run("attitude_trials", drive / "drive.lcm", drive / "poses.csv"))

    tilts = lab.each(range(1, 101), one)
    return {"tilt": f"{math.degrees(rms(t['rms_rad'] for t in tilts)):.2f}",
            "tilt_most": f"{math.degrees(max(t['rms_rad'] for t in tilts)):.2f}",
            "tilt_over_claim": f"{mean(t['over_claim'] for t in tilts):.2f}"}


def hills(lab, seeds):
    """Levelled, and taken as level; the last case is level ground without bumps."""
    def one(case):
        slope, bumps, seed = case
        of = hill_rig(lab, slope, BUMPS_M3[bumps] if bumps else 0.0)
        drive = lab.drive(of, seed)
        judged = []
        for changes in ({}, {"laser.height_m": 0.0}):
            made = lab.map(drive, lab.rig(of, changes), "--quiet")
            figures = lab.judged(made, drive, align=False)
            path = lab.path(made, drive / "poses.csv", "--gap", 0)
            judged.append({"map": figures, "held": held_for_trees(made, drive),
                           "path_percent": 100 * path["ape_position_m"]["rmse"] / path["way_m"],
                           "met": met_by(lab, of, seed, figures["extra"]) if not changes else {}})
        return judged

    cases = [(slope, bumps, seed) for bumps in BUMPS_M3 for slope in SLOPES_PERCENT for seed in seeds] + [(0, 0, seed) for seed in seeds]
    judged = dict(zip(cases, lab.each(cases, one)))

    def figures_of(slopes, bumps, how, name):
        f1, held_f1, error_mm, extra, path = [], [], [], [], []
        for slope in slopes:
            of = [judged[slope, bumps, seed][how] for seed in seeds]
            maps = [j["map"] for j in of]
            held = [j["held"] for j in of]
            error_mm.append(1e3 * mean(m["error_trees"]["rms_m"] for m in maps))
            right = sum(m["confusion"]["tree"]["tree"] for m in maps)
            wrong = sum(m["confusion"]["object"]["tree"] + sum(e["class"] == "tree" for e in m["extra"]) for m in maps)
            f1.append(2 * right / (right + wrong + sum(m["num_trees"] for m in maps)))
            held_f1.append(2 * sum(h[2] for h in held) / sum(h[0] + h[1] for h in held))
            extra.append(mean(m["num_extra"] for m in maps))
            path.append(mean(j["path_percent"] for j in of))
        return {f"{name}f1_{bumps}": span(f1), f"{name}held_{bumps}": span(held_f1), f"{name}error_{bumps}": span(error_mm, 0),
                f"{name}extra_{bumps}": span(extra, 1), f"{name}path_{bumps}": span(path, 3)}

    figures = tilt_errors(lab)
    for how, name in enumerate(("", "level_")):
        for bumps in BUMPS_M3:
            figures.update(figures_of(SLOPES_PERCENT, bumps, how, name))
        figures.update(figures_of((0,), 0, how, name))
    for bumps in BUMPS_M3:
        met = [judged[slope, bumps, seed][0]["met"] for slope in SLOPES_PERCENT for seed in seeds]
        figures[f"met_{bumps}"] = span((mean(m[kind] for m in met) for kind in (*MET, "nothing")), 2)
    return figures


def slope_errors(folder, drive):
    """Of each row, in percent: the line through its trees' heights, beside that through the true heights of the same trees."""
    def percent(points):
        along = [0.0]
        for (a, _), (b, _) in zip(points, points[1:]):
            along.append(along[-1] + math.dist(a, b))
        middle, level = mean(along), mean(z for _, z in points)
        return 100 * sum((s - middle) * (z - level) for s, (_, z) in zip(along, points)) / sum((s - middle) ** 2 for s in along)

    def point(row):
        return (float(row["x_m"]), float(row["y_m"])), float(row["z_m"])

    trees = [point(row) for row in rows_of(drive / "truth.csv") if row["class"] == "tree"]
    rows = {}
    for row in rows_of(folder / "map.csv"):
        if row["row"] and row["position"] and row["z_m"]:
            rows.setdefault(row["row"], []).append((int(row["position"]), point(row)))
    errors = []
    for row in rows.values():
        found = [p for _, p in sorted(row)]
        pairs = [(p, min(trees, key=lambda t: math.dist(t[0], p[0]))) for p in found]
        pairs = [(p, t) for p, t in pairs if math.dist(p[0], t[0]) < 0.3]
        if len(pairs) > 2:
            errors.append(abs(percent([p for p, _ in pairs]) - percent([t for _, t in pairs])))
    return errors


def heights(lab, seeds):
    """Altitudes of RTK with the tilt, alone, and of fixes that err half alike."""
    def one(case):
        slope, seed = case
        of = hill_rig(lab, slope, BUMPS_M3[3])
        alike = lab.rig(of, {"simulation.gnss.sky.wander_sd_m": 0.02})
        judged = []
        for rig, changes in ((of, {}), (of, {"laser.height_m": 0.0}), (alike, {})):
            drive = lab.drive(rig, seed)
            made = lab.map(drive, lab.rig(rig, changes), "--quiet")
            judged.append((lab.judged(made, drive, align=False), slope_errors(made, drive)))
        return judged

    cases = [(slope, seed) for slope in SLOPES_PERCENT for seed in seeds]
    judged = dict(zip(cases, lab.each(cases, one)))
    figures = {}
    for how, name in enumerate(("", "alone_", "alike_")):
        of = {slope: [judged[slope, seed][how] for seed in seeds] for slope in SLOPES_PERCENT}
        heights_of = {slope: [m["error_heights"] for m, _ in maps] for slope, maps in of.items()}
        figures[f"{name}rms"] = span((1e3 * rms(h["rms_m"] for h in maps) for maps in heights_of.values()), 0)
        figures[f"{name}most"] = span((1e3 * max(h["rms_m"] for h in maps) for maps in heights_of.values()), 0)
        figures[f"{name}over_claim"] = span((mean(m["height_nees"] for m, _ in maps) for maps in of.values()), 2)
        figures[f"{name}slope"] = span((max(max(errors) for _, errors in maps) for maps in of.values()), 2)
    return figures


def yard(lab, seeds):
    def one(seed):
        drive = lab.drive(lab.rig("yard"), seed, "yard")
        return [lab.path(lab.map(drive, lab.rig("yard", how), "--quiet"), drive / "poses.csv")["ape_position_m"]["rmse"]
                for how in ({}, {"pose.motion": "scans"})]

    errors = lab.each(seeds, one)
    return {"wheels": f"{mean(e[0] for e in errors):.2f} m; {max(e[0] for e in errors):.2f} m",
            "scans": f"{mean(e[1] for e in errors):.2f} m; {max(e[1] for e in errors):.2f} m"}


def campus(lab, seeds):
    """Streets of houses and hedges; one map at a time, because what each costs is measured."""
    program = lab.digest("campus")
    rigs = {how: lab.rig("yard", {"pose.motion": how}) for how in ("wheels", "scans")}
    paths, processor_s = {}, []
    for seed in seeds:
        for shape in ("streets", "silent", "round"):
            drive = lab.made("campus", {"program": program, "shape": shape, "seed": seed},
                             lambda folder: lab.run("campus", shape, seed, folder / "drive.lcm", folder / "poses.csv"))
            for how, rig in rigs.items():
                lab.say(f"campus {shape} {seed}, motion {how}")
                folder = lab.out / "campus" / f"{shape}-{seed}-{how}"
                before = os.times()
                lab.orchard("map", drive / "drive.lcm", "--config", lab.rig_file(rig), "--out", folder, "--jobs", 1, "--quiet")
                after = os.times()
                processor_s.append(after.children_user + after.children_system - before.children_user - before.children_system)
                paths.setdefault((how, shape), []).append(lab.path(folder, drive / "poses.csv")["ape_position_m"]["rmse"])
    said = {f"{shape}_{how}": span(paths[how, shape], 2) + " m" for how, shape in paths}
    return {**said, "processor": f"{max(processor_s):.0f} s"}


def slam_park(lab, seeds):
    runs = lab.lines("slam_trials", "park", seeds[0], seeds[-1])
    return {"path": f"{sum(r['rmse_m'] <= 0.5 for r in runs)} of {len(runs)}, median {median(r['rmse_m'] for r in runs):.2f} m",
            "twice": f"{sum(r['twice'] for r in runs):.0f}; {sum(r['mixed'] for r in runs):.0f}",
            "nees": f"{mean(r['nees'] for r in runs):.1f}"}


def slam_rows(lab, seeds):
    runs = lab.lines("slam_trials", "rows", seeds[0], seeds[-1])
    right = [r for r in runs if r["end_m"] < 0.5]
    left_open = [r for r in runs if r["end_m"] >= 0.5 and r["sd_m"] > 5.0]
    return {"closed": f"{len(right)} right, {len(left_open)} open, {len(runs) - len(right) - len(left_open)} wrong of {len(runs)}"}


def slam_fixes(lab, seeds):
    bursts, twins = (lab.lines("slam_trials", kind, seeds[0], seeds[-1]) for kind in ("fixes", "twins"))
    off = [r["off_m"] for r in bursts]
    wrong = [r for r in twins if r["off_m"] > 5.0]
    return {"rows": f"{median(off):.2f} m, {max(off):.2f} m", "nees": f"{mean(r['nees'] for r in bursts):.1f}",
            "twins": f"{len(twins) - len(wrong)} of {len(twins)}; {sum(r['doubted'] for r in wrong):.0f} of {len(wrong)}"}


def scale(lab, seeds):
    rig = lab.rig("scale")
    drive = lab.drive(rig, seeds[0])
    folder = lab.out / "scale"
    before = os.times()
    said = lab.orchard("map", drive / "drive.lcm", "--config", lab.rig_file(rig), "--out", folder, "--no-derived", "--jobs", 1,
                       "--timing", both=True)
    after = os.times()
    processor_s = after.children_user + after.children_system - before.children_user - before.children_system
    poses = rows_of(drive / "poses.csv")
    driven_s = (poses[-1]["utime_us"] - poses[0]["utime_us"]) / 1e6
    km = sum(apart(a, b) for a, b in zip(poses, poses[1:])) / 1e3
    memory = [float(m) for m in re.findall(r"^timing: scans.* ([\d.]+) MiB", said, re.M)]
    most = [float(m) for m in re.findall(r"^timing: in all.* ([\d.]+) MiB", said, re.M)]
    result = lab.judged(folder, drive)
    trees = result["num_trees"]
    growth = (memory[-1] - memory[0] - 2 * trees / 1024) / km
    return {"time": f"{processor_s:.0f} s; {driven_s / processor_s:.1f} times",
            "memory": f"{max(memory):.0f} MiB; {most[-1] if most else max(memory):.0f} MiB; {growth:.1f} MiB",
            "trees": f"{trees - result['num_trees_missed']} of {trees}; {result['num_duplicates']}",
            "error": f"{1e3 * result['error_trees']['rms_m']:.1f} mm, "
                     f"{1e3 * lab.path(folder, drive / 'poses.csv')['ape_position_m']['rmse']:.1f} mm"}


def prior_map(lab, seeds):
    first, last = seeds[0], seeds[-1]
    quarter, twentieth = first + (last - first) // 4, first + (last - first) // 20
    start = lab.lines("prior_map_trials", "global", first, last)
    foreign = lab.lines("prior_map_trials", "foreign", first, quarter)
    carried = lab.lines("prior_map_trials", "carried", first, quarter)
    tracked = lab.lines("prior_map_trials", "tracking", first, twentieth)
    again = [c["recovered_m"] for c in carried]
    return {"found": f"{sum(s['right'] for s in start):.0f}, {sum(s['wrong'] for s in start):.0f} of {len(start)}",
            "distance": f"{median(s['travel_m'] for s in start):.1f} m; {max(s['travel_m'] for s in start):.1f} m",
            "foreign": f"{sum(f['right'] + f['wrong'] for f in foreign):.0f} of {len(foreign)}",
            "carried": f"{sum(0 <= m <= 15 for m in again)} of {len(again)}; {median(again):.1f} m",
            "tracking": f"{rms(t['rmse_m'] for t in tracked):.3f} m; {sum(t['lost'] for t in tracked):.0f}"}


def satellites(lab, seeds):
    rig = lab.rig("park", {"pose.mode": "fused", "simulation.motion.gnss_rate_hz": 5.0, "simulation.motion.gnss_sd_m": 0.5, **DATUM,
                           "simulation.gnss.stated_sd_m": 0, "simulation.gnss.sky.wander_sd_m": 1.7,
                           "simulation.gnss.sky.gap_every_s": 40.0, "simulation.gnss.sky.burst_s": 8.0,
                           "simulation.gnss.sky.pause_s": 3.0, "simulation.gnss.sky.multipath_fraction": 0.05})
    config = lab.rig_file(rig)
    runs = sum(lab.each(seeds, lambda s: lab.lines("satellites", config, "park", s, s)), [])
    late = [r["smoothed_m"] for r in runs]
    return {"smoothed": f"{sum(m <= 3 for m in late)} of {len(late)}; {median(late):.1f} m, {max(late):.1f} m",
            "told": f"{median(r['told_m'] for r in runs):.1f} m, {max(r['told_m'] for r in runs):.1f} m",
            "left_out": f"{sum(r['left_out_s'] > 2 for r in runs)} of {len(runs)}; {max(r['left_out_s'] for r in runs):.0f} s",
            "nees": f"{mean(r['nees_told'] for r in runs):.1f}; {mean(r['nees_smoothed'] for r in runs):.1f}",
            "gaps": f"{sum(r['gaps_good'] for r in runs):.0f} of {sum(r['gaps'] for r in runs):.0f}"}


# maps

def strays(truth, landmarks, far_m=0.3):
    """Landmarks where nothing of the truth stands."""
    return [m for m in landmarks if not any(apart(m, t) < far_m + t["width_m"] / 2 for t in truth)]


def trees_found(truth, landmarks, reach_m=3.0):
    """(trees near landmarks, of them with a tree within 0.3 m)."""
    trees = [t for t in truth if t["class"] == "tree" and any(apart(m, t) < reach_m for m in landmarks)]
    return len(trees), sum(any(m["class"] == "tree" and apart(m, t) < 0.3 for m in landmarks) for t in trees)


def with_truth(lab, rig, seeds, scene="orchard", seconds=0, looks=False):
    """(truth, landmarks, map folder, drive) of each seed."""
    def one(seed):
        drive = lab.drive(rig, seed, scene, seconds, looks=looks)
        folder = lab.map(drive, rig, "--quiet")
        return rows_of(drive / "truth.csv"), rows_of(folder / "map.csv"), folder, drive

    return lab.each(seeds, one)


ABOUT = {"simulation.clutter.num_people": 3, "simulation.clutter.people_around": "true"}


def people(lab, seeds):
    runs = with_truth(lab, lab.rig("orchard", {**ABOUT, "camera.enabled": "false"}), seeds)
    found = [trees_found(truth, marks) for truth, marks, _, _ in runs]
    left = [strays(t, m) for t, m, _, _ in runs]
    return {"without": f"{sum(not marks for marks in left)} of {len(runs)}",
            "left": f"{sum(map(len, left))}, {sum(m['n'] >= 4 for marks in left for m in marks)}",
            "trees": f"{sum(f for _, f in found)} of {sum(n for n, _ in found)}"}


def moving_things(lab, seeds):
    rig = lab.rig("block", {"simulation.orchard.laps": 1, "simulation.orchard.fix_rate_hz": 10, "pose.mode": "fixes",
                            "simulation.clutter.num_people": 12, "simulation.clutter.num_vehicles": 4})
    runs = with_truth(lab, rig, seeds)
    found = [trees_found(t, m, math.inf) for t, m, _, _ in runs]
    return {"ghosts": f"{sum(len(strays(t, m, 0.4)) for t, m, _, _ in runs)}",
            "trees": f"{sum(f for _, f in found)} of {sum(n for n, _ in found)}"}


def bushes(lab, seeds):
    runs = with_truth(lab, lab.rig("orchard_hard", {"simulation.clutter.leaf_depth_m": 0.15}), seeds, seconds=45, looks=True)
    within = []
    for truth, marks, _, _ in runs:
        # whatever is 0.4 to 0.8 m wide and no crate or post counts as a bush
        wide = [t for t in truth if t["class"] == "object" and 0.4 <= t["width_m"] <= 0.8 and t["width_m"] not in (0.4, 0.6)]
        within += [sum(m["class"] != "tree" and apart(m, b) < b["width_m"] / 2 for m in marks) for b in wide]
    looks = lab.looks([m for _, _, m, _ in runs], [d for _, _, _, d in runs])
    return {"one": f"{within.count(1)} of {sum(n > 0 for n in within)}",
            "strays": f"{mean(len(strays(t, m)) for t, m, _, _ in runs):.1f}",
            "trees": f"{looks['landmarks']['f1']:.3f}; {looks['observations']['f1']:.3f}"}


def hedges(lab, seeds):
    rig = lab.rig("yard", {"pose.mode": "fixes", "simulation.orchard.fix_rate_hz": 10})
    along = []
    for _, marks, _, _ in with_truth(lab, rig, seeds, "yard", 300):
        along.append([m for m in marks if 20 < m["x_m"] < 22 and 15 < m["y_m"] < 63])  # the hedge beside the block
    lines = [[m["length_m"] for m in marks if float(m["length_m"] or 0) > 0] for marks in along]
    return {"lines": f"{sum(len(one) == 1 for one in lines)} of {len(lines)}; {min(map(sum, lines)):.0f} m",
            "beside": f"{mean(len(m) - len(one) for m, one in zip(along, lines)):.1f}"}


def free_ways(lab, seeds):
    rig = lab.rig("orchard", {"camera.enabled": "false", "detector.tree_threshold": 0.1})
    check = str(ROOT / "tests/system/free_ways/check_ways.py")

    def checked(*arguments):
        done = subprocess.run([sys.executable, check, *map(str, arguments)], text=True, capture_output=True, check=False)
        lab.say(done.stdout.strip())
        return done.returncode == 0

    free = [checked(folder, "--truth", drive / "truth.csv") for _, _, folder, drive in with_truth(lab, rig, seeds, seconds=90)]
    real = []
    for name in ("pullally_drive_1", "pullally_drive_2"):
        log, source = lab.recording(name)
        real.append(checked(lab.map(log, lab.rig("pullally"), "--quiet"), "--recording", source))
    return {"simulated": f"{sum(free)} of {len(free)}", "real": f"{sum(real)} of {len(real)}"}


# two days, several robots, plans

def frame(true_poses, poses):
    """From a map's frame into the truth's, by the first pose."""
    true, own = rows_of(true_poses)[0], rows_of(poses)[0]
    turn = true["yaw_rad"] - own["yaw_rad"]
    c, s = math.cos(turn), math.sin(turn)

    def place(row):
        return {"x_m": c * (row["x_m"] - own["x_m"]) - s * (row["y_m"] - own["y_m"]) + true["x_m"],
                "y_m": s * (row["x_m"] - own["x_m"]) + c * (row["y_m"] - own["y_m"]) + true["y_m"]}

    return place


def true_changes(before, after):
    """[(kind, place)] of trees, and where posts and bushes came or went."""
    kinds, stays = [], []
    trees = [[t for t in day if t["class"] == "tree"] for day in (before, after)]
    for b in trees[0]:
        same = next((a for a in trees[1] if apart(a, b) < 0.02), None)
        moved = same or next((a for a in trees[1] if a not in stays and abs(a["width_m"] - b["width_m"]) < 1.5e-4 and
                              apart(a, b) < 1.7 and not any(apart(a, o) < 0.02 for o in trees[0])), None)
        if same is not None and same["width_m"] - b["width_m"] > 0.0015:
            kinds.append(("grown", same))
        elif same is None:
            kinds.append(("moved", moved) if moved else ("missing", b))
        stays += [moved] if moved else []
    kinds += [("new", a) for a in trees[1] if a not in stays]
    objects = [[o for o in day if o["class"] == "object"] for day in (before, after)]
    return kinds, [o for one, other in (objects, objects[::-1]) for o in one if not any(apart(o, p) < 0.02 for p in other)]


def changed_days(lab, seed, mode):
    """Judged claims of one block before and after: counts by kind, false ones of the unchanged block, ids."""
    before = lab.rig("block", {"pose.mode": mode, "simulation.orchard.laps": 1, "simulation.orchard.fix_rate_hz": 10})
    same = overlay(before, {"simulation.scanner.rate_hz": 9.0})  # so that the later drive's noise is its own
    changed = overlay(same, {f"simulation.change.{key}": value for key, value in {
        "fraction": 0.05, "moved_fraction": 0.05, "moved_m": 0.5, "moved_spread_m": 1.0, "growth_m": 0.04, "grown_fraction": 0.05,
        "objects_fraction": 0.1}.items()})
    drives = [lab.drive(rig, seed) for rig in (before, same, changed)]
    first = lab.map(drives[0], before, "--quiet")
    maps = [first, lab.map(drives[1], same, "--quiet"),
            lab.map(drives[2], changed, "--quiet", "--previous", first, changed=first.name)]

    def place_of(i):
        return frame(drives[i] / "poses.csv", (drives[i] / "poses.csv") if mode == "fixes" else (maps[i] / "trajectory.csv"))

    counts, truths = {}, [rows_of(d / "truth.csv") for d in drives]
    for i, name in ((1, "same"), (2, "changed")):
        out = lab.out / f"compared_{mode}_{seed}_{name}"
        lab.orchard("compare", first, maps[i], "--out", out)
        kinds, objects = true_changes(truths[0], truths[i])
        for kind, _ in kinds:
            counts[name, kind, "true"] = counts.get((name, kind, "true"), 0) + 1
        for claim in rows_of(out / "compare.csv"):
            kind = claim["change"]
            if kind in ("unchanged", "not_seen"):
                continue
            at = place_of(0)(claim)
            right = next((k for k in kinds if k[0] == kind and apart(k[1], at) < 0.3), None)
            if right:
                kinds.remove(right)
            verdict = "right" if right else "object" if any(apart(o, at) < 1.0 for o in objects) else "false"
            counts[name, kind, verdict] = counts.get((name, kind, verdict), 0) + 1
    marks = [[{**m, **place_of(i)(m)} for m in rows_of(maps[i] / "map.csv")] for i in (0, 2)]
    for tree in (t for t in truths[2] if t["class"] == "tree" and any(apart(t, b) < 0.02 for b in truths[0])):
        old, new = (min(m, key=lambda mark: apart(mark, tree)) for m in marks)
        if apart(old, tree) < 0.4 and apart(new, tree) < 0.4:
            counts["ids", "pairs", ""] = counts.get(("ids", "pairs", ""), 0) + 1
            same_name = all(old[k] == new[k] for k in ("id", "row", "position"))
            counts["ids", "other", ""] = counts.get(("ids", "other", ""), 0) + (not same_name)
    return counts


def map_changes(lab, seeds):
    figures = {}
    for mode in ("fixes", "slam"):
        all_counts = {}
        for counts in lab.each(seeds, lambda seed, mode=mode: changed_days(lab, seed, mode)):
            for key, number in counts.items():
                all_counts[key] = all_counts.get(key, 0) + number
        shown = []
        for kind in ("missing", "new", "moved", "grown"):
            right, false, true = (all_counts.get(("changed", kind, what), 0) for what in ("right", "false", "true"))
            shown.append(f"{right / max(1, right + false):.3f}, {right / max(1, true):.3f}")
        false = sum(n for (name, _, verdict), n in all_counts.items() if name == "same" and verdict == "false")
        figures[f"{mode}_changes"] = "; ".join(shown)
        figures[f"{mode}_same"] = f"{false}"
        if mode == "fixes":
            figures["ids"] = f"{all_counts.get(('ids', 'other', ''), 0)} of {all_counts.get(('ids', 'pairs', ''), 0)}"
    return figures


def two_maps(lab, seeds):
    changes = lab.lines("two_map_trials", "changes", seeds[0], seeds[-1])
    ids = lab.lines("two_map_trials", "ids", seeds[0], seeds[-1])
    merges = lab.lines("two_map_trials", "merge", seeds[0], seeds[min(9, len(seeds) - 1)])
    of = {c["kind"]: c for c in changes if c["width_sd_m"] == 0.004}
    near = [m for m in merges if m["case"].startswith("three robots")]
    not_one = [m for m in merges if "planted" in m["case"] or "chessboard" in m["case"] or "nothing" in m["case"]]
    num = len(seeds[:10])
    return {"changes": "; ".join(f"{of[k]['right'] / max(1, of[k]['right'] + of[k]['wrong']):.3f}, "
                                 f"{of[k]['right'] / max(1, of[k]['true']):.3f}" for k in ("missing", "new", "moved", "grown")),
            "ids": f"{sum(i['ids'] for i in ids):.0f}, {sum(i['numbers'] for i in ids):.0f} of {sum(i['pairs'] for i in ids):.0f}",
            "merged": f"{sum(m['merged'] for m in near):.0f} of {num * len(near)}; {sum(m['twice'] + m['lost'] for m in near):.0f}",
            "refused": f"{sum(m['refused'] for m in not_one):.0f} of {num * len(not_one)}; "
                       f"{sum(m['wrong'] for m in merges):.0f}"}


def large_maps(lab, seeds):
    runs = sum(lab.each(seeds, lambda s: lab.lines("large_map_trials", 20000, s, s)), [])
    one = [r for r in runs if not r["other"]]
    return {"laid": f"{sum(r['right'] for r in one):.0f} of {len(one)}; {mean(r['took_s'] for r in one):.1f} s",
            "others": f"{sum(r['refused'] for r in runs if r['other']):.0f} of {len(runs) - len(one)}; "
                      f"{max((r['took_s'] for r in runs if r['other']), default=math.nan):.1f} s"}


def merge_robots(lab, seeds):
    slam = lab.rig("block", {"simulation.orchard.laps": 1})
    fixes = overlay(slam, {"pose.mode": "fixes", "simulation.orchard.fix_rate_hz": 10})
    parts = ((0, 45, fixes), (35, 75, slam), (65, 100, slam))

    def one(seed):
        whole = lab.drive(fixes, seed)
        poses = rows_of(whole / "poses.csv")
        way_s = (poses[-1]["utime_us"] - poses[0]["utime_us"]) / 1e6
        maps = [lab.map(lab.drive(rig, seed, start_s=int(way_s * begin / 100), seconds=int(way_s * (end - begin) / 100)), rig,
                        "--quiet") for begin, end, rig in parts]
        out = lab.out / f"merged_{seed}"
        lab.orchard("merge", *maps, "--any-place", "--out", out)
        return json.loads(lab.orchard("evaluate", "map", out, "--truth", whole / "truth.csv", "--align", "--json"))

    runs = lab.each(seeds, one)
    return {"trees": f"{sum(r['num_trees'] - r['num_trees_missed'] for r in runs)} of {sum(r['num_trees'] for r in runs)}, "
                     f"{1e3 * rms(r['error_trees']['rms_m'] for r in runs):.0f} mm"}


def plans(lab, seeds):
    runs = lab.lines("plan_trials", seeds[0], seeds[-1])
    laid = [r for r in runs if r["laid"]]
    true, false, over = (sum(r[k] for r in laid) for k in ("true", "false", "overlooked"))
    return {"names": f"{sum(r['named'] for r in laid):.0f} of {sum(r['named'] + r['misnamed'] for r in laid):.0f}",
            "deviations": f"{true / max(1, true + false):.3f}, {true / max(1, true + over):.3f}"}


def rows(lab, seeds):
    figures = []
    for name in ("pullally_drive_1", "pullally_drive_2"):
        log, _ = lab.recording(name)
        for rig in ("pullally", "pullally_laser_only"):
            folder = lab.map(log, lab.rig(rig, {"mapper.min_observations": 2}), "--quiet")
            figures += lab.lines("row_trials", "map", folder / "map.csv", 5, 4.3, len(seeds))
    planted = lab.lines("row_trials", "planted", seeds[0], seeds[-1])[0]
    return {"real": ", ".join(f"{f['right']:.0f}" for f in figures) + f" of {len(seeds)}",
            "planted": f"{planted['right']:.0f} of {planted['num']:.0f}"}


def album(lab, seeds):
    runs = lab.lines("album_seeds", ROOT / "config/orchard.yaml", seeds[0], seeds[-1])
    return {"photographs": "{:.0f} of {:.0f}; {:.0f}".format(*(sum(r[k] for r in runs) for k in ("photographed", "mapped", "centred")))}


# real recordings

def real(lab, seeds):
    figures = {}
    for number, name in ((1, "pullally_drive_1"), (2, "pullally_drive_2")):
        log, source = lab.recording(name)
        folder = lab.map(log, lab.rig("pullally"), "--quiet")
        alone = lab.map(log, lab.rig("pullally_laser_only"), "--quiet")
        said = lab.run("clear_trees", source, folder)
        clear = re.search(r"clear trees: (\d+); with one tree landmark: (\d+)", said).groups()
        figures[f"clear_{number}"] = f"{clear[1]} of {clear[0]}"
        path = lab.path(alone, source / "poses.csv")["ape_position_m"]
        figures[f"path_{number}"] = f"{path['rmse']:.3f} m, {path['max']:.2f} m"
        ten_keys = lab.rig("pullally_laser_only", {"detector.segmentation.blind_half_width_rad": 0.0,
                                                   "mapper.observation_range_max_m": 100.0})
        same = lab.run("clear_trees", source, lab.map(log, ten_keys, "--quiet"), folder)
        facts = lab.made("learnt", {"program": lab.digest("orchard"), "log": log.name},
                         lambda made, log=log: lab.orchard("learn", log / "drive.lcm", "--out", made / "rig.yaml"))
        said = lab.run("clear_trees", source, lab.map(log, (facts / "rig.yaml").read_text(), "--quiet"))
        figures[f"learnt_{number}"] = "{1} of {0}".format(
            *re.search(r"clear trees: (\d+); with one tree landmark: (\d+)", said).groups())
        figures[f"ten_{number}"] = "{} of {}".format(*re.search(r"one landmark for (\d+) of (\d+)", same).groups())
    log, source = lab.recording("koala_poles")
    folder = lab.map(log, lab.rig("koala"), "--quiet")
    ends = re.findall(r"lie ([\d.]+) m and ([\d.]+) degrees", lab.run("return_trip", source, folder, ROOT / "config/koala.yaml"))
    figures["koala"] = "; ".join(f"{m} m, {d} degrees" for m, d in ends)
    return figures


VINEYARD = """laser: {range_sd_m: 0.02}
camera: {enabled: false}
detector:
  segmentation: {range_max_m: 8.0, blind_centre_rad: 3.1416, blind_half_width_rad: 0.6}
  width: {mean_m: 0.05, sd_m: 0.02}
  tree_threshold: 0.2
mapper: {min_observations: 5}
"""


def hull_of(points):
    """The convex hull of points, counter-clockwise."""
    def turns_left(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0])
    hull = []
    for side in (sorted(points), sorted(points, reverse=True)):
        chain = []
        for point in side:
            while len(chain) > 1 and not turns_left(chain[-2], chain[-1], point):
                chain.pop()
            chain.append(point)
        hull += chain[:-1]
    return hull


def is_in(hull, x, y):
    """True inside of a counter-clockwise convex hull, or on it."""
    return all((bx - ax) * (y - ay) >= (by - ay) * (x - ax) for (ax, ay), (bx, by) in zip(hull, hull[1:] + hull[:1]))


def surveyed(folder, truth):
    """A map against surveyed things in their frame: found, landmarks of the block that are one, mapped twice, vines and posts told apart by rows."""
    things = [(row["class"] == "tree", float(row["x_m"]), float(row["y_m"])) for row in rows_of(truth)]
    landmarks = [(row["row"] != "", float(row["x_m"]), float(row["y_m"])) for row in rows_of(folder / "map.csv")]
    apart_m = [[math.hypot(x - at_x, y - at_y) for _, x, y in landmarks] for _, at_x, at_y in things]
    found = [(is_vine, row) for (is_vine, *_), row in zip(things, apart_m) if min(row) < 0.3]
    block = hull_of([(x, y) for _, x, y in things])
    nearest_m = [m for m, (_, x, y) in zip(map(min, zip(*apart_m)), landmarks) if m < 0.3 or is_in(block, x, y)]
    twice = sum(sum(m < 0.3 for m in row) > 1 for row in apart_m)
    told = sum(landmarks[row.index(min(row))][0] == is_vine for is_vine, row in found)
    return (f"{len(found)} of {len(things)}; {100 * sum(m < 0.3 for m in nearest_m) / len(nearest_m):.0f} %; {twice}; "
            f"{told} of {len(found)}")


def vineyard(lab, seeds):
    """Riseholme by the scanner's facts alone: the path against RTK, what the program says of its end, and the map against the survey."""
    log, source = lab.recording("riseholme_run_1")
    ways = {"dead": {"pose.mode": "odometry", "pose.motion": "scans"},
            "wheels": {"pose.mode": "slam"},
            "scans": {"pose.mode": "slam", "pose.motion": "scans"},
            "gnss": {"pose.mode": "slam", "pose.motion": "scans", "pose.slam.use_gnss": "true"}}
    figures = {}
    for key, changes in ways.items():
        folder = lab.map(log, lab.rig(VINEYARD, changes), "--quiet")
        path = lab.path(folder, source / "poses.csv")["ape_position_m"]
        quality = [finding["name"] for finding in json.loads((folder / "summary.json").read_text())["quality"]]
        figures[key] = f"{path['rmse']:.2f} m, {path['max']:.1f} m; " + (", ".join(quality) or "no doubt")
    alone = lab.made("laser_alone", {"log": log.name},
                     lambda made: altered_log(log / "drive.lcm", made / "drive.lcm", lambda channel, data: None if channel == "ODOMETRY" else data))
    paths = [lab.path(lab.map(alone, lab.rig(VINEYARD, {"pose.mode": mode, "pose.motion": "scans"}), "--quiet"), source / "poses.csv")["ape_position_m"]
             for mode in ("odometry", "slam")]
    figures["alone"] = "; ".join(f"{path['rmse']:.2f} m, {path['max']:.1f} m" for path in paths)
    tracked = {"track": {"pose.mode": "slam", "pose.motion": "scans", "pose.slam.use_fixes": "true"}, "track_alone": {"pose.mode": "fixes"}}
    for key, changes in tracked.items():
        figures[key] = surveyed(lab.map(log, lab.rig(VINEYARD, changes), "--quiet"), source / "truth.csv")
    return figures


def in_rows(judged):
    """A path by the rows, and as de Silva et al. 2026 (arXiv 2603.10847) judge theirs."""
    rows = judged["rows"]
    return (f"APE {judged['ape_position_m']['rmse']:.2f} m; cross-track {rows['cross_track_rms_m']:.2f}, {rows['cross_track_median_m']:.2f}, "
            f"{rows['cross_track_95_m']:.2f} m; right aisle {100 * rows['right_aisle']:.0f} %, wrong {rows['wrong_longest_s']:.0f} s, "
            f"{rows['wrong_longest_m']:.0f} m; nearest row right {100 * rows['nearest_row']:.0f} %, from it {rows['from_row_mean_m']:.2f} m")


def located(lab, log, source, motion, start, changes=None, mapped=None):
    """What `evaluate localisation` says of a drive in its survey, or in a map, and its folder."""
    rig = lab.rig(VINEYARD, {"pose.motion": motion, **(changes or {})})

    def locate(made):
        said = lab.orchard("evaluate", "localisation", log / "drive.lcm", "--map", mapped or source / "truth.csv", "--config", lab.rig_file(rig), *start,
                           "--out", made, "--json")
        (made / "said.json").write_text(said)

    programs = [lab.digest("orchard"), log.name, rig, start] + ([mapped.name] if mapped else [])
    made = lab.made("shadow", programs, locate)
    return json.loads((made / "said.json").read_text()), made


def at_common_times(*paths):
    """The places of paths [m, complex] at the times that all of them have."""
    paths = [{row["utime_us"]: complex(row["x_m"], row["y_m"]) for row in rows_of(path)} for path in paths]
    common = sorted(set.intersection(*(set(path) for path in paths)))
    return [[path[t] for t in common] for path in paths]


def aligned(a, b):
    """Places a, moved rigidly onto b."""
    middle_a, middle_b = mean(a), mean(b)
    turn = sum((p - middle_a).conjugate() * (q - middle_b) for p, q in zip(a, b))
    return [turn / abs(turn) * (p - middle_a) + middle_b for p in a]


def errors_of_three(paths):
    """The errors of three paths [m, per axis], if they are independent, by how far each two of them are apart after a rigid alignment
    (the three-cornered hat; Gray and Allan 1974)."""
    a, b, c = at_common_times(*paths)
    ab, bc, ca = (mean(abs(p - q) ** 2 for p, q in zip(aligned(x, y), y)) for x, y in ((a, b), (b, c), (c, a)))
    return [max(0.0, twice / 4) ** 0.5 for twice in (ca + ab - bc, ab + bc - ca, bc + ca - ab)]


def agreeing_where_wrong(track, place, graph, wrong_m=0.5):
    """Of the poses of a place that are farther than wrong_m from the track, those that the graph of trunks says within half of that."""
    track, place, graph = at_common_times(track, place, graph)
    wrong = [abs(p - q) < wrong_m / 2 for p, q, true in zip(place, aligned(graph, place), track) if abs(p - true) > wrong_m]
    return f"{sum(wrong)} of {len(wrong)}"


def vineyard_rows(lab, seeds):
    """Riseholme by its surveyed rows, beside the published figures of its own authors."""
    log, source = lab.recording("riseholme_run_1")
    figures = {}
    for key, changes in {"dead": {"pose.mode": "odometry", "pose.motion": "scans"}, "wheels": {"pose.mode": "slam"},
                         "scans": {"pose.mode": "slam", "pose.motion": "scans"}}.items():
        graph = lab.map(log, lab.rig(VINEYARD, changes), "--quiet")
        figures[key] = in_rows(lab.path(graph, source / "poses.csv", "--align", "--rows", source / "truth.csv"))
    for key, motion, start in (("search", "scans", []), ("start", "scans", ["--start-known"]), ("start_wheels", "wheels", ["--start-known"])):
        run, made = located(lab, log, source, motion, start)
        figures[key] = f"with a pose {100 * run['placed_time_share']:.0f} % of the time, LOST {run['lost_s']:.0f} s, " \
                       f"AMBIGUOUS {run['ambiguous_s']:.0f} s, wrong without a warning {run['wrong_s']:.0f} s"
        if run["placed_time_share"]:
            near, _, far = run["within"]
            figures[key] += f"; within 0.1 m {100 * near['time_share']:.0f} %, 0.5 m {100 * far['time_share']:.0f} %, NEES {run['nees']:.0f}; " \
                + in_rows(lab.path(made, source / "poses.csv", "--rows", source / "truth.csv"))
    start = ["--start-known"]
    located_path = located(lab, log, source, "scans", start)[1] / "trajectory.csv"
    track_m, located_m, graph_m = errors_of_three([source / "poses.csv", located_path, graph / "trajectory.csv"])
    run = located(lab, log, source, "scans", [*start, "--truth-sd", f"{track_m:.2f}"])[0]
    figures["hat"] = f"{track_m:.2f}, {located_m:.2f}, {graph_m:.2f} m; {run['claimed_sd_m'] / 2 ** 0.5:.2f} m; {run['nees']:.1f}; " \
                     + agreeing_where_wrong(source / "poses.csv", located_path, graph / "trajectory.csv")
    first = rows_of(source / "poses.csv")[0]
    runs = []
    for aisles in (-1, 1):
        start = {"start": "given", "start_x_m": float(first["x_m"]) + 2.46 * aisles, "start_y_m": float(first["y_m"]) + 0.42 * aisles,
                 "start_yaw_rad": float(first["yaw_rad"])}
        runs.append(located(lab, log, source, "scans", [], {f"pose.prior_map.{key}": str(value) for key, value in start.items()})[0])
    figures["aside"] = "; ".join(f"{100 * run['placed_time_share']:.0f} %, {run['wrong_s']:.0f} s" for run in runs)
    return figures


def vineyard_starts(lab, seeds):
    """Riseholme located in its survey from scans anywhere on the drive, without a stated start."""
    log, source = lab.recording("riseholme_run_1")

    def one(seed):
        num_scans, first = 0, random.Random(seed).randrange(1000)  # of 1,205

        def late(channel, data):
            nonlocal num_scans
            num_scans += channel == "SCAN"
            return data if num_scans > first else None

        rest = lab.made("late_start", {"log": log.name, "first": first},
                        lambda folder: altered_log(log / "drive.lcm", folder / "drive.lcm", late))
        return located(lab, rest, source, "scans", [])[0]

    runs = lab.each(seeds, one)
    return {"starts": ", ".join(f"{100 * run['placed_time_share']:.0f} %" for run in runs) + "; "
            + ", ".join(f"{run['wrong_s']:.0f} s" for run in runs)}


def vineyard_halves(lab, seeds):
    """Each half of Riseholme located in the map of the other: most of its aisles are not in that map."""
    log, source = lab.recording("riseholme_run_1")
    half = 602  # of 1,205 scans

    def halved(is_first):
        num_scans = 0

        def keep(channel, data):
            nonlocal num_scans
            num_scans += channel == "SCAN"
            return data if (num_scans <= half) == is_first else None

        return lab.made("half_drive", {"log": log.name, "half": half, "first": is_first},
                        lambda folder: altered_log(log / "drive.lcm", folder / "drive.lcm", keep))

    halves = [halved(True), halved(False)]
    tracked = lab.rig(VINEYARD, {"pose.mode": "slam", "pose.motion": "scans", "pose.slam.use_fixes": "true"})
    maps = [lab.map(part, tracked, "--quiet") for part in halves]
    figures = {}
    for key, drive, mapped in (("second", halves[1], maps[0]), ("first", halves[0], maps[1])):
        runs = [located(lab, drive, source, "scans", start, mapped=mapped)[0] for start in ([], ["--start-known"])]
        figures[key] = ", ".join(f"{100 * run['placed_time_share']:.0f} %" for run in runs) + "; " \
            + ", ".join(f"{run['wrong_s']:.0f} s" for run in runs)
    return figures


def vineyard_again(lab, seeds):
    """Riseholme with another 3 % of its scans left out for each seed: how far a figure hangs on single scans."""
    log, source = lab.recording("riseholme_run_1")

    def one(seed):
        draw = random.Random(seed)

        def thin(channel, data):
            return None if channel == "SCAN" and draw.random() < 0.03 else data

        fewer = lab.made("fewer_scans", {"log": log.name, "seed": seed},
                         lambda folder: altered_log(log / "drive.lcm", folder / "drive.lcm", thin))
        paths = [lab.path(lab.map(fewer, lab.rig(VINEYARD, {"pose.mode": mode, "pose.motion": "scans"}), "--quiet"),
                          source / "poses.csv")["ape_position_m"]["rmse"] for mode in ("slam", "odometry")]
        return *paths, located(lab, fewer, source, "scans", ["--start-known"])[0]

    slam, dead, runs = zip(*lab.each(seeds, one))
    return {"paths": f"{mean(slam):.2f} ({min(slam):.2f}-{max(slam):.2f}) m; {mean(dead):.2f} ({min(dead):.2f}-{max(dead):.2f}) m",
            "start": ", ".join(f"{100 * run['placed_time_share']:.0f} %" for run in runs) + "; "
                     + ", ".join(f"{run['wrong_s']:.0f} s" for run in runs)}


def into_track(folder, poses):
    """From a map's frame into that of a recording's poses.csv, by the rigid motion that fits both paths best."""
    own, track = ({row["utime_us"]: complex(row["x_m"], row["y_m"]) for row in rows_of(path)}
                  for path in (folder / "trajectory.csv", poses))
    both = sorted(own.keys() & track.keys())
    middle_own, middle_track = mean(own[t] for t in both), mean(track[t] for t in both)
    turn = sum((own[t] - middle_own).conjugate() * (track[t] - middle_track) for t in both)
    return lambda row: turn / abs(turn) * (complex(row["x_m"], row["y_m"]) - middle_own) + middle_track


def certainty(lab, seeds):
    things = rows_of(ROOT / "tests/experiments/pullally_things.csv")
    facts = lab.rig("pullally_laser_only", {"detector.segmentation.blind_half_width_rad": 0.0,
                                            "mapper.observation_range_max_m": 100.0})
    figures = {}
    for key, rig in (("alone", lab.rig("pullally_laser_only")), ("facts", facts)):
        judged = []
        for number in (1, 2):
            log, source = lab.recording(f"pullally_drive_{number}")
            folder = lab.map(log, rig, "--quiet")
            place = into_track(folder, source / "poses.csv")
            stands = [(complex(t["x_m"], t["y_m"]), t["class"] == "tree") for t in things if t["drive"] == number]
            told = []  # (probability, whether it is a tree)
            once = 0
            marks = [place(row) for row in rows_of(folder / "map.csv") if row["class"] == "tree"]
            for at, is_tree in stands:
                once += is_tree and sum(abs(at - mark) < 0.5 for mark in marks) == 1
            for row in rows_of(folder / "map.csv"):
                distance_m, is_tree = min((abs(p - place(row)), is_tree) for p, is_tree in stands)
                told.append((row["probability"], is_tree and distance_m < 0.55))
            bins = [[(p, t) for p, t in told if min(9, int(10 * p)) == b] for b in range(10)]
            error = sum(abs(sum(p - t for p, t in one)) for one in bins) / len(told)
            judged.append((f"{error:.3f}", f"{sum(p > 0.9 and not t for p, t in told)}",
                           f"{sum(p > 0.9 and t for p, t in told)} of {sum(t for _, t in told)}",
                           f"{once} of {sum(is_tree for _, is_tree in stands)}"))
        figures[key] = "; ".join(", ".join(each) for each in zip(*judged))
    people = []
    legs = lab.rig("pullally_laser_only", {"detector.segmentation": None, "pose.mode": "stationary", "pose.motion": None,
                                           "mapper.observation_range_max_m": None})
    for bag in ("demo_stationary_simple_environment", "positive_1"):
        marks = rows_of(lab.map(lab.recording(f"legs_2d/{bag}.bag")[0], legs, "--quiet") / "map.csv")
        people.append(f"{sum(m['class'] == 'tree' and m['probability'] >= 0.95 for m in marks)} of "
                      f"{sum(m['class'] == 'tree' for m in marks)}")
    figures["people"] = ", ".join(people)
    return figures


def second_visit(lab, seeds):
    logs = [lab.recording(f"pullally_drive_{n}") for n in (1, 2)]
    maps = [lab.map(log, lab.rig("pullally"), "--quiet") for log, _ in logs]
    judged = []
    for earlier, later in ((0, 1), (1, 0)):
        kept = lab.map(logs[later][0], lab.rig("pullally"), "--quiet", "--previous", maps[earlier], changed=maps[earlier].name)
        rig = lab.rig("pullally_laser_only", {"pose.mode": "prior_map", "pose.prior_map.map_file": maps[earlier].resolve()})
        placed = lab.map(logs[later][0], rig, "--quiet", changed=maps[earlier].name)
        judged += lab.lines("second_visit", logs[earlier][1], maps[earlier], maps[later], kept, placed)
    return {"placed": ", ".join(f"{j['rmse_m']:.3f} m" for j in judged),
            "claims": ", ".join(f"{j['claims']:.0f}" for j in judged),
            "ids": ", ".join(f"{j['with_id']:.0f} of {j['in_both']:.0f}" for j in judged)}


def altered_drives(lab, seeds):
    recording = lab.data / "pullally_drive_1"
    names = [line.split()[0] for line in lab.run("altered_drive", "names").splitlines()]

    def one(name):
        what = {"recording": str(recording), "name": name, "seed": seeds[0], "program": lab.digest("altered_drive")}
        log = lab.made("altered", what, lambda f: lab.run("altered_drive", "write", recording, name, seeds[0], f / "drive.lcm"))
        maps = [lab.map(log, lab.rig(rig), "--quiet") for rig in ("pullally", "pullally_laser_only")]
        return lab.lines("altered_drive", "judge", recording, name, seeds[0], *maps)[0]

    runs = lab.each(names, one)
    return {key: f"{sum(r[once] for r in runs):.0f} of {sum(r['clear'] for r in runs):.0f}; {sum(r[twice] for r in runs):.0f}"
            for key, once, twice in (("track", "once", "twice"), ("alone", "once_alone", "twice_alone"))}


# pictures of the pages

def draw_page(folder, picture):
    """A map's page in a browser, with a tree that was clicked; returns the picture."""
    sys.path.insert(0, str(ROOT / "tests/system/view"))
    import browser
    browser.require_chromium()
    with browser.Browser(1100, 700) as page:
        page.open(f"file://{folder}/map.html")
        page.run("orchardApp.select(orchardApp.model.at(4, 5), true); orchardApp.paintNow()")
        page.picture(str(picture))
    return picture


def draw_figures(lab):
    """{name in scripts/figures: picture}: the demo's map, Pullally's, two maps compared, and a map's page."""
    tubes_rig = lab.rig("tubes")
    before = lab.rig("block", {"pose.mode": "fixes", "simulation.orchard.laps": 1, "simulation.orchard.fix_rate_hz": 10,
                               "simulation.orchard.num_rows": 9, "simulation.orchard.trees_per_row": 10})
    after = overlay(before, {"simulation.scanner.rate_hz": 9.0, **{f"simulation.change.{key}": value for key, value in {
        "fraction": 0.05, "moved_fraction": 0.05, "grown_fraction": 0.05, "moved_m": 0.5, "moved_spread_m": 1.0,
        "growth_m": 0.04}.items()}})
    first = lab.map(lab.drive(before, 1), before, "--quiet")
    second = lab.map(lab.drive(after, 1), after, "--quiet", "--previous", first, changed=first.name)
    lab.orchard("compare", first, second, "--out", lab.out / "compared")
    pictures = {"demo_map.png": lab.map(lab.drive(tubes_rig, 1, "tubes"), tubes_rig, "--quiet") / "map.png",
                "compare.png": lab.out / "compared/compare.png"}
    pictures["map_page.png"] = draw_page(first, lab.out / "map_page.png")
    if (lab.data / "pullally_drive_1").is_dir():
        pictures["pullally_map.png"] = lab.map(lab.recording("pullally_drive_1")[0], lab.rig("pullally"), "--quiet") / "map.png"
    return pictures

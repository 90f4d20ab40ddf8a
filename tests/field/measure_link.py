# SPDX-License-Identifier: BSD-3-Clause
"""Measurements over a bad link: loss, repetition, disorder, a cut, a narrow one."""
import time

import wire
from drive import Drive, TwoHosts
from maps import Total, rows
from table import Row

# what the detector reads; of these it tells its losses
DETECTOR_INPUTS = ("SCAN", "IMAGE", "ODOMETRY")
WANTED_TREES_percent = {0.01: 0.0, 0.05: 1.0, 0.2: 5.0}


def orchard_drive(bench, arguments, seed=None):
    return Drive(bench, "config/orchard.yaml", arguments.seed if seed is None else seed,
                 20.0 if arguments.short else 0.0)


def loss(bench, arguments):
    """Whole messages, or single frames of them, lost between two hosts: the map, what is reported."""
    found = []
    # A drive has some 20 to 35 trees, so that one of them is 3 to 5 %: several are judged together.
    seeds = [arguments.seed + i for i in range(1 if arguments.short else 4)]
    drives = [orchard_drive(bench, arguments, seed) for seed in seeds]
    for whole in (1, 0):
        unit = "messages" if whole else "frames"
        for share in (0.05,) if arguments.short else (0.01, 0.05, 0.2):
            # At real time: at twice the speed a gap looks like a clock that leapt.
            runs = [TwoHosts(bench, drive, 1.0,
                             {"--loss": share, "--whole": whole, "--seed": drive.seed}) for drive in drives]
            found.append(trees_row(f"{100 * share:g} % of all {unit} lost", runs, WANTED_TREES_percent[share]))
            found.append(replay_row("loss", f"{100 * share:g} % of all {unit} lost", runs))
            lost, sent = (sum(values) for values in zip(*(run.true_loss(DETECTOR_INPUTS) for run in runs)))
            told = sum(run.status["detector"].num_lost for run in runs if run.status["detector"])
            found.append(Row("loss", f"{100 * share:g} % of all {unit}: messages lost, told against true",
                             f"{100 * told / sent:.2f} against {100 * lost / sent:.2f} %", "within 1",
                             abs(told - lost) <= 0.01 * sent))
    if not arguments.short:
        found.append(detector_beside_sensors(bench, drives, arguments.speed))
    return found


def trees_row(what, runs, wanted_percent):
    """Trees gone and new over several drives; of a share below one tree, one tree is allowed."""
    total = Total(run.compared for run in runs)
    allowed = max(1 if wanted_percent > 0.0 else 0, int(wanted_percent / 100.0 * total.num))
    return Row("loss", what + ": map", str(total), f"at most {wanted_percent:g} %: {allowed}",
               total.gone + total.new <= allowed)


def replay_row(name, what, runs):
    """Whether each live map is that of what its host heard."""
    same = sum(run.replay.same_bytes for run in runs)
    worst = next((str(run.replay) for run in runs if not run.replay.same_bytes), "the same bytes")
    return Row(name, what + ": live against the replay of what arrived", f"{same} of {len(runs)} drives; {worst}",
               "the same bytes", same == len(runs))


def detector_beside_sensors(bench, drives, speed):
    """What the page on deployment advises where frames are lost: pictures do not cross the link."""
    runs = [TwoHosts(bench, drive, speed, {"--loss": 0.2, "--seed": drive.seed}, beside_sensors=("detector",))
            for drive in drives]
    return trees_row("20 % of all frames lost, the detector beside the sensors", runs, 5.0)


def loss_default_kernel(bench, arguments):
    """The same 5 % with the kernel's own store of fragments."""
    drive = orchard_drive(bench, arguments)
    run = TwoHosts(bench, drive, arguments.speed, {"--loss": 0.05, "--seed": arguments.seed},
                   sysctls={})
    difference = run.compared
    return [Row("loss_default_kernel", "5 % of all frames lost, sysctls as the kernel has them: map",
                str(difference), "(for comparison)", None)]


def duplicates(bench, arguments):
    """A tenth of the frames twice: the map has the same bytes."""
    drive = orchard_drive(bench, arguments)
    run = TwoHosts(bench, drive, arguments.speed, {"--duplicate": 0.1, "--seed": arguments.seed})
    difference = run.compared
    return [Row("duplicates", "10 % of all frames twice: map", str(difference), "the same bytes",
                difference.same_bytes), replay_row("duplicates", "10 % of all frames twice", [run])]


def reorder(bench, arguments):
    """Every frame late by 0 to 50 ms: nothing changes."""
    drive = orchard_drive(bench, arguments)
    # at real time: 50 ms of a faster replay were more of the drive
    run = TwoHosts(bench, drive, 1.0, {"--jitter-ms": 50, "--seed": arguments.seed})
    difference = run.compared
    status = run.status["detector"]
    num_lost, num_sent = run.true_loss(DETECTOR_INPUTS)
    told = (status.num_lost, status.num_duplicate) if status else (-1, -1)
    return [
        Row("reorder", "every frame late by 0 to 50 ms: map", str(difference), "no difference",
            difference.gone + difference.new == 0),
        Row("reorder", "the same: reported lost, repeated; truly lost",
            f"{told[0]}, {told[1]}; {num_lost} of {num_sent}", "0, 0; 0", told == (0, 0)),
        replay_row("reorder", "every frame late by 0 to 50 ms", [run]),
    ]


def levelled(bench, arguments):
    """A robot that sways on a slope, its scans levelled by its IMU: its nodes over a link that delays and repeats."""
    drive = Drive(bench, "config/hills.yaml", arguments.seed, 20.0 if arguments.short else 60.0)
    run = TwoHosts(bench, drive, 1.0, {"--jitter-ms": 20, "--duplicate": 0.1, "--seed": arguments.seed})
    lost, num = run.true_loss(("SCAN", "ODOMETRY", "IMU", "GNSS"))
    return [
        Row("levelled", f"scans levelled by the IMU, packets up to 20 ms late and a tenth twice; {lost} of {num} messages lost: "
            "the live map against that of the log in one process", run.compared, "the same bytes", run.compared.same_bytes),
        Row("levelled", "the live map against that of what its host heard", run.replay, "the same bytes", run.replay.same_bytes),
    ]


def slow_link(bench, arguments):
    """10 Mbit/s, at real time: no message is lost."""
    drive = orchard_drive(bench, arguments)
    run = TwoHosts(bench, drive, 1.0, None, rate_mbit=10)
    difference = run.compared
    num_lost, num_sent = run.true_loss(DETECTOR_INPUTS)
    return [Row("slow_link", "10 Mbit/s: SCAN, IMAGE and ODOMETRY lost; map",
                f"{num_lost} of {num_sent}; {difference}", "0", num_lost == 0)]


def link_down(bench, arguments):
    """The link cut for 10 s in mid-drive: who says so, how soon, and what becomes of the ids."""
    drive = Drive(bench, "config/orchard.yaml", arguments.seed)
    gap_s = 10.0
    told = {}

    def during(run, network, listener, nodes):
        if not listener.wait(lambda s: s.name == "orchard-mapper" and s.num_good > 300, 60):
            return
        time.sleep(20.0)
        told["before"] = rows(run_map(bench))
        cut = time.monotonic()
        network.links["mapping"].cut()
        time.sleep(gap_s)
        mended = time.monotonic()
        network.links["mapping"].mend()
        time.sleep(4.0)
        for name in ("detector", "pose"):
            heard = listener.statuses("orchard-" + name, cut + 0.05)
            stale = next((a for a, s in heard if a < mended and s.level != 0), None)
            # the share that was lost is told for 10 s more, as a warning
            back = next((a for a, s in heard if a > mended + 0.05 and "STALE" not in s.text), None)
            told[name] = (stale and stale - cut, back and back - mended)
            told[name + " text"] = next((s.text for a, s in heard if s.level != 0), "")

    def run_map(bench):
        return f"{bench.work}/two_hosts/map.csv"

    run = TwoHosts(bench, drive, 1.0, {"--seed": arguments.seed}, during=during)
    found = []
    for name in ("detector", "pose"):
        stale, back = told.get(name, (None, None))
        found.append(Row("link_down", f"{name}: says so after; is no longer STALE after",
                         f"{seconds(stale)}; {seconds(back)}", "1 s; 2 s",
                         stale is not None and back is not None and stale <= 1.0 and back <= 2.0))
    before = {row["id"]: row for row in told.get("before", []) if row["class"] == "tree"}
    after = {row["id"]: row for row in rows(run.map)}
    kept = sum(1 for i, row in before.items() if i in after and
               abs(after[i]["x"] - row["x"]) + abs(after[i]["y"] - row["y"]) < 0.3)
    found.append(Row("link_down", "ids of the trees before it kept", f"{kept} of {len(before)}", "all",
                     kept == len(before) > 0))
    found.append(Row("link_down", "map against the drive without it", str(run.compared),
                     "(10 s are missing)", None))
    found.append(replay_row("link_down", "10 s without a link", [run]))
    return found


def seconds(value):
    return "never" if value is None else f"{value:.2f} s"

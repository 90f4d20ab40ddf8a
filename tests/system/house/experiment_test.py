#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""experiment_test.py SOURCE_TREE: tests/RESULTS.md is what the stored figures make; rigs take overlays; what an
older program made is not used again, and jobs at once share what one of them makes."""
import concurrent.futures
import os
import pathlib
import subprocess
import sys
import tempfile
import threading

sys.dont_write_bytecode = True
TREE = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(TREE / "tests/experiments"))
import catalogue  # noqa: E402
import lab  # noqa: E402

RIG = """# a comment
pose:
  mode: slam  # how
  slam:
    use_gnss: false
detector:
  width:
    mean_m: 0.1
"""


def check_overlays():
    changed = lab.overlay(RIG, {"pose.mode": "fixes", "pose.slam.use_gnss": True, "pose.gnss.datum": "[1, 2, 3]", "detector.width": None,
                                "simulation.orchard.laps": 2, "pose.none": None})
    assert changed == """# a comment
pose:
  gnss:
    datum: [1, 2, 3]
  mode: fixes
  slam:
    use_gnss: true
detector:
simulation:
  orchard:
    laps: 2
""", changed


def check_store(folder):
    (folder / "bin").mkdir()
    program = folder / "bin/orchard"
    program.write_text("first")
    bench = lab.Lab(folder, folder / "out", 1, folder, is_quiet=True)
    times = []

    def make(out):
        times.append(out)
        (out / "log").write_text("made")

    def of(rig):
        return bench.made("log", {"program": bench.digest("orchard"), "rig": rig}, make)

    assert (of("a") / "log").read_text() == "made" and of("a") == of("a") != of("b")
    assert len(times) == 2, times
    program.write_text("another program")
    of("a")
    assert len(times) == 3, "what an older program made was used again"
    check_jobs_at_once(bench)
    # A rig that a program may be reading is not written again.
    path = bench.rig_file(RIG)
    os.utime(path, (1, 1))
    assert bench.rig_file(RIG).stat().st_mtime == 1 and path.read_text() == RIG
    assert list(path.parent.iterdir()) == [path]


def check_jobs_at_once(bench):
    """Jobs that want the same thing at once get one whole thing, made once."""
    together, made = threading.Barrier(8), []

    def make(out):
        made.append(out)
        (out / "log").write_text("a part")
        for _ in range(50):
            assert [file.name for file in out.iterdir()] == ["log"]
        (out / "log").write_text("the whole")

    def job(_):
        together.wait()
        return (bench.made("log", {"at": "once"}, make) / "log").read_text()

    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        assert list(pool.map(job, range(8))) == 8 * ["the whole"]
    assert len(made) == 1, made


def check_catalogue():
    sections = [section for section, _ in catalogue.SECTIONS]
    for name, experiment in catalogue.EXPERIMENTS.items():
        assert experiment.section in sections, name
        assert not (experiment.trial and experiment.command), name
    stored = {path.stem for path in (TREE / "tests/experiments/results").glob("*.json")}
    assert stored <= set(catalogue.EXPERIMENTS), stored - set(catalogue.EXPERIMENTS)


check_overlays()
with tempfile.TemporaryDirectory() as work:
    check_store(pathlib.Path(work))
check_catalogue()
sys.exit(subprocess.run([sys.executable, "-B", TREE / "tests/experiments/experiment", "page", "--check"], check=False).returncode)

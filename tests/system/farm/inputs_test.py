# SPDX-License-Identifier: BSD-3-Clause
"""A result is what its name says, whatever happens while a run goes on: files change, the disk fills, a
node lacks a mount or has other programs, memory is short. Usage: inputs_test.py SOURCE_TREE BIN."""
import hashlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

from small_drive import make_drive

SOURCE, BIN = sys.argv[1], pathlib.Path(sys.argv[2])
ORCHARD = str(BIN / "orchard")
SNAKEMAKE = shutil.which("snakemake")
CAN_MOUNT = os.geteuid() == 0 and subprocess.run(["unshare", "-m", "true"],
                                                 capture_output=True).returncode == 0
LIMITS_MEMORY = unittest.skipIf(os.environ.get("ORCHARD_SANITIZED"), "sanitizers reserve terabytes of addresses")


class Inputs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.drives = [folder.name + f"/drive_{k}.lcm" for k in range(3)]
        for k, drive in enumerate(cls.drives):
            make_drive(SOURCE, ORCHARD, drive, rate_hz=6.0 + k)
        cls.drives.append(folder.name + "/drive_3.lcm")  # of another orchard
        make_drive(SOURCE, ORCHARD, cls.drives[3], spacing_m=2.9)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.farm = self.folder / "farm"
        self.orchard("init", self.farm)
        self.rig = self.farm / "rigs" / "mule.yaml"

    def orchard(self, command, *arguments, code=0, program=ORCHARD, before="", cwd=None):
        """Runs a command of orchard farm; `before`: of the shell, such as a limit."""
        words = [str(program), "farm", command, *map(str, arguments)]
        if before:
            words = ["unshare", "-m", "bash", "-ec", before + '; exec "$@"', "bash", *words]
        done = subprocess.run(words, capture_output=True, text=True, cwd=cwd or self.folder)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def add(self, k=0, date="2026-01-01", robot="mule"):
        self.orchard("add", self.farm, self.drives[k], "--block=north", "--date", date, "--robot",
                     robot)
        return self.farm / "logs" / "north" / date / robot / f"drive_{k}.lcm"

    def use_rig(self, k=0):
        shutil.copy(self.drives[k] + ".yaml", self.rig)

    def run_with(self, while_running, code=0):
        """A run at whose begin, once it has listed its steps, a shell command changes something."""
        path = self.folder / "path"
        path.mkdir(exist_ok=True)
        (path / "snakemake").write_text(f'#!/bin/bash\n{while_running}\nexec {SNAKEMAKE} "$@"\n')
        (path / "snakemake").chmod(0o755)
        old = os.environ["PATH"]
        os.environ["PATH"] = f"{path}:{old}"
        try:
            return self.orchard("run", self.farm, "--cores", 2, code=code)
        finally:
            os.environ["PATH"] = old

    def num_made(self, *options):
        return int(self.orchard("run", self.farm, "--cores", 2, *options).stdout.split()[0])

    def list_steps(self):
        """Lists the steps without making one."""
        self.run_with("exit 0", code=1)
        return json.loads((self.farm / "work" / "tasks.json").read_text())["tasks"]

    def step(self, kind="map"):
        return next(name for name in self.list_steps() if name.startswith(kind))

    def map_words(self, name):
        task = json.loads((self.farm / "work" / "tasks.json").read_text())["tasks"][name]
        rig = ["--config", task["rig"]] if task["rig"] else []
        return [ORCHARD, "map", *task["logs"], *rig, "--quiet", "--no-derived", "--out", "@out"]

    def make(self, name, *words, **options):
        """One step, as the Snakefile calls it."""
        return self.orchard("step", name, "--", *(words or self.map_words(name)), cwd=self.farm,
                            **options)

    def status(self):
        return json.loads(self.orchard("status", self.farm, "--json").stdout)

    def findings(self):
        return {f["what"]: f["reason"] for f in self.status()["findings"]}

    def result(self, name):
        return self.farm / "results" / name

    def require_nothing_made(self, name):
        self.assertFalse(self.result(name).exists())
        self.assertEqual(list((self.farm / "results").glob(".making-*")), [])
        self.assertEqual(self.status()["steps"]["map"]["set_aside"], 0)


class WhileARunGoesOn(Inputs):
    def test_a_rig_that_is_edited_is_used_as_it_was(self):
        self.add()
        self.use_rig()
        self.run_with(f"sed -i 's/range_max_m: 10.0/range_max_m: 7.0/' {self.rig}")
        before = {p.name: (p / "map.csv").read_bytes() for p in self.farm.glob("results/map-*")}
        self.assertEqual(self.num_made(), 3, "the edited rig has a map, a date and a report of its own")
        after = {p.name: (p / "map.csv").read_bytes() for p in self.farm.glob("results/map-*")}
        self.assertEqual(len(after), 2)
        self.use_rig()  # as it was: nothing is to be made, and the old name holds the old rig's map
        self.assertEqual(self.num_made(), 0)
        alone = self.folder / "alone"
        subprocess.run([ORCHARD, "map", self.drives[0], "--config", self.rig, "--quiet", "--out", alone],
                       check=True, capture_output=True)
        self.assertEqual(list(before.values()), [(alone / "map.csv").read_bytes()])

    def test_a_log_that_is_still_copied_gives_no_result_under_its_old_name(self):
        log = self.add()
        whole = log.read_bytes()
        log.write_bytes(whole[:len(whole) // 2])
        said = self.run_with(f"cat {self.drives[0]} >{log}", code=1)
        self.assertIn("has changed since", said.stdout)
        self.assertEqual(list(self.farm.glob("results/map-*")), [])
        self.assertEqual(self.num_made(), 3)
        self.assertEqual(self.findings(), {}, "the whole log was mapped")

    def test_an_input_that_changes_while_a_step_reads_it_is_found_after_it(self):
        log = self.add()
        name = self.step()
        words = self.map_words(name)
        said = self.make(name, "bash", "-c", f'"$@"; printf x >>{log}', "bash", *words, code=1)
        self.assertIn("has changed since", said.stderr)
        self.require_nothing_made(name)

    def test_corrections_made_meanwhile_are_found(self):
        self.add()
        self.add(1, "2026-02-01")
        self.assertEqual(self.num_made(), 7)
        self.orchard("publish", self.farm)
        self.add(2, "2026-02-01", "horse")
        edit = f"{ORCHARD} edit delete {self.farm}/maps/north/2026-01-01 1 --who ana"
        said = self.run_with(edit, code=1)
        self.assertIn("corrections of results/date-", said.stdout)
        self.num_made()
        date = self.orchard("publish", self.farm)
        self.assertIn("2 maps", date.stdout)
        self.assertTrue((self.farm / "maps/north/2026-02-01/corrections.jsonl").exists())

    def test_a_prior_map_is_an_input(self):
        self.add()
        self.assertEqual(self.num_made(), 3)
        shutil.copytree(next(self.farm.glob("results/map-*")), self.farm / "plans" / "winter")
        self.add(1, "2026-02-01", "horse")
        rig = pathlib.Path(self.drives[1] + ".yaml").read_text()
        self.assertIn("mode: fixes", rig)
        rig = rig.replace("mode: fixes", "mode: prior_map\n  prior_map:\n    map_file: ./plans/winter")
        (self.farm / "rigs" / "horse.yaml").write_text(rig)
        self.assertEqual(self.num_made(), 4)
        table = self.farm / "plans" / "winter" / "map.csv"
        rows = table.read_text().splitlines()
        table.write_text("\n".join(rows[:-1]) + "\n")
        self.assertEqual(self.num_made(), 4, "another prior map makes another map")
        self.add(2, "2026-03-01", "horse")
        said = self.run_with(f"sed -i '$d' {table}", code=1)
        self.assertIn("plans/winter/map.csv has changed since", said.stdout)

    def test_a_comment_in_a_rig_makes_nothing_anew(self):
        self.add()
        self.use_rig()
        self.assertEqual(self.num_made(), 3)
        text = self.rig.read_text()
        self.rig.write_text("# of the mule\n" + text + "\n\ndrivers:\n  laser:\n    device: tcp:10.0.0.1:1\n")
        self.assertEqual(self.num_made(), 0)
        self.rig.write_text(text.replace("range_max_m: 10.0", "range_max_m: 9.0"))
        self.assertEqual(self.num_made(), 3)
        self.rig.write_text(text.replace("range_max_m: 10.0", "range_max_m: -1"))
        self.num_made()
        self.assertRegex(self.findings()["set aside (map)"], r"rigs/mule.yaml:\d+: .*range_max_m = -1")


    def test_the_copy_of_a_rig_means_what_the_rig_means(self):
        def meaning(rig):
            done = subprocess.run([BIN / "orchard-mapper", "--config", rig, "--print-config", "--all"],
                                  capture_output=True, text=True, check=True)
            sections = re.split(r"^(?=\w)", done.stdout, flags=re.M)
            return [s for s in sections if not re.match("lcm|drivers|simulation", s)]

        rigs = sorted((pathlib.Path(SOURCE) / "config").glob("*.yaml"))
        for rig in rigs:
            self.add(robot=rig.stem)
            shutil.copy(rig, self.farm / "rigs")
        copies = {drive.split("/")[2]: task["rig"] for task in self.list_steps().values()
                  if task["kind"] == "map" for drive in task["of"]}
        self.assertGreater(len(rigs), 10)
        for rig in rigs:
            copy = self.farm / copies[rig.stem]
            self.assertEqual(meaning(copy), meaning(rig), rig.stem)
            self.assertEqual(hashlib.sha256(copy.read_bytes()).hexdigest(), copy.stem)


class OnlyFunctionsOfTheInput(Inputs):
    def test_a_full_disk_is_no_bad_log(self):
        if not CAN_MOUNT:
            self.skipTest("needs root and mount namespaces")
        self.add()
        name = self.step()
        for kb in (4, 200, 400):  # it fills at the first file, among them, and at the last
            said = self.make(name, code=1, before="mkdir -p results && mount -t tmpfs -o "
                             f"size={kb}k none results")
            self.assertIn("No space left", said.stderr)
        self.require_nothing_made(name)
        self.assertIn("No space left", self.findings()["failed (map)"])
        self.make(name)
        self.assertEqual(self.status()["steps"]["map"]["good"], 1)

    def test_a_node_without_the_mount_is_no_bad_log(self):
        if not CAN_MOUNT:
            self.skipTest("needs root and mount namespaces")
        self.add()
        name = self.step()
        said = self.make(name, code=1, before="mount -t tmpfs none logs/north")
        self.assertIn("cannot be read", said.stderr)
        self.require_nothing_made(name)

    @LIMITS_MEMORY
    def test_short_memory_is_no_bad_log(self):
        self.add()
        name = self.step()
        words = self.map_words(name)
        for kb in range(40_000, 200_000, 20_000):  # it is short at one place or another, or suffices
            limited = ["bash", "-c", f'ulimit -v {kb}; exec "$@"', "bash"]
            trial = [word.replace("@out", str(self.folder / "trial")) for word in words]
            if subprocess.run(limited + trial, cwd=self.farm, capture_output=True).returncode != 0:
                self.make(name, *limited, *words, code=1)
        self.require_nothing_made(name)

    @LIMITS_MEMORY
    def test_a_crash_under_a_memory_limit_is_not_set_aside_and_another_is(self):
        self.add()
        name = self.step()
        crash = ["bash", "-c", "echo lost >&2; kill -SEGV $$"]
        said = self.orchard("step", name, "--", *crash, code=1, cwd=self.farm,
                            before="ulimit -v 4000000")
        self.assertIn("139", said.stderr)
        self.require_nothing_made(name)
        self.make(name, *crash)
        self.assertIn("crashed (signal 11): lost", self.findings()["set aside (map)"])

    def test_another_build_makes_nothing(self):
        self.add()
        name = self.step()
        other = self.folder / "bin"
        other.mkdir()
        for program in ("orchard", "orchard-maps", "orchard-gis"):
            shutil.copy(BIN / program, other / program)
        with open(other / "orchard-maps", "ab") as file:
            file.write(b"another build")
        said = self.make(name, program=other / "orchard", code=1)
        self.assertIn("are not those of `orchard farm run`", said.stderr)
        self.require_nothing_made(name)

    def test_why_the_cluster_ended_a_step_is_told(self):
        self.add()
        name = self.step()
        lot = next(iter(json.loads((self.farm / "work" / "lots.json").read_text())["maps"]))
        job = self.farm / "work" / "slurm" / f"{lot}.txt"
        job.parent.mkdir()
        job.write_text("Building DAG of jobs...\nslurmstepd: error: Detected 1 oom_kill event\n")
        self.assertEqual(self.findings(),
                         {"failed (map)": "slurmstepd: error: Detected 1 oom_kill event"})
        with open(job, "a", encoding="ascii") as file:
            file.write("slurmstepd: error: *** JOB 5 ON node CANCELLED AT 2026-11-27T12:30:59 ***\n")
        self.assertIn("oom_kill", self.findings()["failed (map)"], "why, not only that it was cancelled")
        self.make(name)
        self.assertEqual(self.findings(), {})

    def test_the_reason_is_what_was_said_last_of_the_error(self):
        self.add()
        name = self.step()
        self.make(name, "bash", "-c", "echo orchard map: no trees >&2; echo aligned on 5636 trunks; exit 3")
        self.assertEqual(self.findings()["set aside (map)"], "orchard map: no trees")

    def test_what_was_set_aside_is_tried_again(self):
        self.add()
        self.add(1)
        name = self.step()
        self.make(name, "bash", "-c", "exit 3")
        self.assertEqual(self.num_made(), 3)
        self.orchard("retry", self.farm, "no such step", code=3)
        said = self.orchard("retry", self.farm, f"north/2026-01-01/mule/drive_0")
        self.assertIn("3 results removed", said.stdout)
        self.assertEqual(self.num_made(), 3)
        self.assertEqual(self.status()["steps"]["map"], {"good": 2, "set_aside": 0, "open": 0})
        self.assertIn("0 results", self.orchard("retry", self.farm).stdout)


class ResultsAreKept(Inputs):
    def test_an_altered_or_deleted_result_is_found(self):
        self.add()
        self.add(1, "2026-02-01")
        self.num_made()
        self.orchard("publish", self.farm)
        self.orchard("verify", self.farm)
        a, b = sorted(self.farm.glob("results/map-*"))
        with open(a / "map.csv", "a") as file:
            file.write("\n")
        (b / "map.gpkg").unlink()
        shutil.rmtree((self.farm / "reports/north/2026-02-01").resolve())
        said = self.orchard("verify", self.farm, code=3).stdout
        self.assertIn(f"results/{a.name}: map.csv was altered", said)
        self.assertIn(f"results/{b.name}: map.gpkg is missing", said)
        self.assertIn("reports/north/2026-02-01: results/report-", said)
        # nothing is made of them
        self.add(2, "2026-01-01")
        said = self.orchard("run", self.farm, code=1).stdout
        self.assertRegex(said, r"failed \(date\): north/2026-01-01: .*(was altered|is missing)")
        for result in (a, b):
            self.orchard("retry", self.farm, result.name)
        self.num_made()
        self.orchard("publish", self.farm)
        self.orchard("verify", self.farm)

    def test_what_nobody_needs_is_removed(self):
        self.add()
        self.use_rig()
        self.num_made()
        self.orchard("publish", self.farm)
        published = {link.resolve().name for link in self.farm.glob("*/north/*") if link.is_symlink()}
        self.rig.write_text(self.rig.read_text().replace("range_max_m: 10.0", "range_max_m: 9.0"))
        self.num_made()
        dead = self.farm / "results" / ".making-map-0123-a.dead.node-77"
        dead.mkdir()
        before = {p.name for p in self.farm.glob("results/*-*")}
        said = self.orchard("clean", self.farm).stdout
        self.assertIn("1 results removed", said, "the old map; date and report are published")
        after = {p.name for p in self.farm.glob("results/*-*")}
        self.assertEqual(len(before - after), 2)
        self.assertFalse(dead.exists())
        self.assertLessEqual(published, after)
        self.assertEqual(self.num_made(), 0)
        self.assertEqual(len(list(self.farm.glob("work/rigs/*"))), 1)
        shutil.rmtree(self.farm / "logs/north")
        self.assertIn("is its disk mounted?", self.orchard("clean", self.farm, code=3).stderr)

    def test_status_and_a_dry_run_write_nothing(self):
        if not CAN_MOUNT:
            self.skipTest("needs root and mount namespaces")
        self.add()
        read_only = f"mount --bind {self.farm} {self.farm}; mount -o remount,ro,bind {self.farm}"
        said = self.orchard("run", self.farm, "--dry-run", before=read_only).stdout
        self.assertIn("map      north/2026-01-01/mule/drive_0", said)
        self.assertIn("3 steps to make", said)
        self.assertIn("0 made", self.orchard("status", self.farm, before=read_only).stdout)
        self.num_made()
        self.assertIn("1 made", self.orchard("status", self.farm, before=read_only).stdout)

    def test_logs_may_be_linked(self):
        self.orchard("add", self.farm, self.drives[0], "--block=north", "--date=2026-01-01",
                     "--robot=mule", "--link")
        self.assertTrue((self.farm / "logs/north/2026-01-01/mule/drive_0.lcm").is_symlink())
        self.assertEqual(self.num_made(), 3)


class ADateIsNotLost(Inputs):
    def ids(self, date):
        with open(self.farm / "maps/north" / date / "map.csv") as file:
            return {line.split(",")[0] for line in file.readlines()[1:]}

    def test_by_a_log_of_another_block(self):
        for k, date in enumerate(["2026-01-01", "2026-02-01", "2026-03-01"]):
            self.add([0, 3, 1][k], date)
        self.num_made()
        self.orchard("publish", self.farm)
        first, foreign, third = map(self.ids, ["2026-01-01", "2026-02-01", "2026-03-01"])
        self.assertFalse(first & foreign, "other trees have other ids")
        self.assertGreater(len(first & third), 0.8 * len(first), "the third date carries on the first")
        found = [(f["what"], f["of"], f["reason"]) for f in self.status()["findings"]]
        self.assertIn(("not joined", "north/2026-02-01"), [(what, of) for what, of, _ in found])
        for what, _, reason in found:
            if what == "not joined":
                self.assertIn("cannot be aligned with", reason)
        self.assertTrue((self.farm / "changes/north/2026-03-01/compare.csv").is_file())
        changes = json.loads((self.farm / "changes/north/2026-03-01/compare.json").read_text())
        self.assertGreater(changes["counts"]["unchanged"], 0.8 * len(first))


class Stopped(Inputs):
    def test_a_run_that_is_stopped_leaves_nothing_running(self):
        self.add()
        snakefile = self.farm / "Snakefile"
        text = snakefile.read_text()
        command = "farm step {wildcards.lot}"
        self.assertIn(command, text)
        snakefile.write_text(text.replace(command, command + " -- sleep 86421"))
        for stop in (signal.SIGTERM, signal.SIGKILL):
            run = subprocess.Popen([ORCHARD, "farm", "run", self.farm, "--cores", "1"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            self.wait_for(lambda: self.processes("sleep 86421"))
            run.send_signal(stop)
            run.wait(timeout=60)
            self.wait_for(lambda: not self.processes(f"{SNAKEMAKE} --snakefile"))
            if stop == signal.SIGTERM:
                self.assertEqual(self.processes("sleep 86421"), [])
                self.assertEqual(list(self.farm.glob("results/.making-*")), [])
            for pid in self.processes("sleep 86421"):
                os.kill(pid, signal.SIGKILL)

    def processes(self, words):
        """Processes of this farm with these words in their command line."""
        found = []
        for entry in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                line = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
                if words in line and "farm step" not in line and os.path.realpath(entry / "cwd").startswith(
                        os.path.realpath(self.farm)):
                    found.append(int(entry.name))
            except OSError:
                continue
        return found

    def wait_for(self, condition, tries=600):
        for _ in range(tries):
            if condition():
                return
            subprocess.run(["sleep", "0.1"])
        self.fail("waited in vain")


if __name__ == "__main__":
    if SNAKEMAKE is None:
        print("skipped: snakemake is not installed")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])

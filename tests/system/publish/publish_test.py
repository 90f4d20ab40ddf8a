# SPDX-License-Identifier: BSD-3-Clause
"""orchard publish against a real PostgreSQL with PostGIS: what is in the tables, history, roles,
two publishers at once, and one that is killed. Usage: publish_test.py BIN README."""
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import maps  # noqa: E402
import server as postgres  # noqa: E402

ORCHARD = sys.argv[1] + "/orchard"
README = sys.argv[2]
ROWS, TREES = 4, 12


def wait_for(what, seconds=60):
    """Asks again and again; each question is a psql of its own."""
    end = time.monotonic() + seconds
    while not what():
        if time.monotonic() > end:
            raise AssertionError("this did not come")


class Publish(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = postgres.Server().__enter__()
        cls.folder = tempfile.mkdtemp(prefix="orchard_publish_")

    @classmethod
    def tearDownClass(cls):
        cls.server.__exit__()
        shutil.rmtree(cls.folder)

    def tearDown(self):
        self.server.sql("TRUNCATE orchard.tree, orchard.tree_replaced, orchard.visit")

    def map_of(self, name, growth_m=lambda row: 0.0, left_out=(), georeferenced=False):
        """A map folder: row r, place k has id 100 r + k."""
        folder = os.path.join(self.folder, name)
        lines = [maps.landmark(100 * row + k, 2 * k - 2, 4 * row - 4, row, k, 0.1 + 0.001 * k + growth_m(row))
                 for row in range(1, ROWS + 1) for k in range(1, TREES + 1) if 100 * row + k not in left_out]
        maps.write_map(folder, lines, georeference=maps.datum(-27.6, 151.9, 500.0) if georeferenced else None)
        return folder

    def command(self, folder, *more, block="north", date="2026-04-10"):
        return [ORCHARD, "publish", folder, "--to", self.server.url(), "--block", block, "--date",
                date, *more]

    def publish(self, *arguments, **named):
        done = subprocess.run(self.command(*arguments, **named), capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def count(self, table="tree", where="true"):
        return int(self.server.sql(f"SELECT count(*) FROM orchard.{table} WHERE {where}")[0])

    def test_growth_per_row_as_the_page_has_it(self):
        self.publish(self.map_of("spring"))
        self.publish(self.map_of("autumn", lambda row: 0.003 * row, left_out={203}),
                     date="2026-10-02")
        with open(README) as page:
            query = re.search(r"```sql\n(.*?)```", page.read(), re.S).group(1)
        lines = [line.split("|") for line in self.server.sql(query)]
        self.assertEqual(len(lines), ROWS)
        for row, line in enumerate(lines, 1):
            places = [k for k in range(1, TREES + 1) if (row, k) != (2, 3)]
            area = sum(math.pi / 4 * ((0.1 + 0.001 * k + 0.003 * row) ** 2 - (0.1 + 0.001 * k) ** 2)
                       for k in places)
            self.assertEqual([int(line[0]), int(line[1])], [row, len(places)])
            self.assertAlmostEqual(float(line[2]), 3.0 * row, places=3)
            self.assertAlmostEqual(float(line[3]), 1e4 * area, delta=0.0501)

    def test_place_on_the_earth(self):
        self.publish(self.map_of("placed", georeferenced=True))
        line = self.server.sql("SELECT ST_SRID(place), round(ST_X(place)::numeric, 8), "
                               "round(ST_Y(place)::numeric, 8) FROM orchard.tree WHERE id = 101")
        self.assertEqual(line, ["4326|151.90000000|-27.60000000"])
        # by PostGIS' own geodesic; 22 m at 500 m above the ellipsoid
        metres = self.server.sql(
            "SELECT ST_Distance(a.place::geography, b.place::geography) FROM orchard.tree a, "
            "orchard.tree b WHERE a.id = 101 AND b.id = 112")
        self.assertAlmostEqual(float(metres[0]), 22.0 * (1 - 500.0 / 6371000.0), places=3)

    def test_again_replaces_and_keeps_what_it_replaced(self):
        self.publish(self.map_of("first"))
        out = self.publish(self.map_of("second", lambda row: 0.01 if row == 1 else 0.0, {401, 402}))
        self.assertIn("14 rows of an earlier publication", out)
        self.assertEqual(self.count(), ROWS * TREES - 2)
        self.assertEqual(self.count("tree_replaced", "id / 100 = 1 AND width_m < 0.115"), TREES)
        self.assertEqual(self.count("tree_replaced", "id IN (401, 402)"), 2)
        self.assertEqual(self.server.sql("SELECT num_trees FROM orchard.visit"),
                         [str(ROWS * TREES - 2)])
        self.publish(self.map_of("second", lambda row: 0.01 if row == 1 else 0.0, {401, 402}))
        self.assertEqual(self.count("tree_replaced"), 14)  # nothing changed: nothing was replaced

    def with_heights(self, folder, z_m):
        """The map with a height of the ground for row 1."""
        with open(folder + "/map.csv") as file:
            header, *lines = file.read().splitlines()
        with open(folder + "/map.csv", "w") as file:
            file.write(header + ",length_m,direction_deg,z_m,z_sd_m\n")
            for line in lines:
                file.write(line + (f",,,{z_m:.4f},0.0700\n" if len(line.split(",")[0]) == 3 and line[0] == "1" else ",,,,\n"))
        return folder

    def test_heights_of_the_ground_and_their_change(self):
        self.publish(self.with_heights(self.map_of("hill"), 12.5))
        self.assertEqual(self.count("tree_now", "z_m = 12.5 AND z_sd_m = 0.07 AND id / 100 = 1"), TREES)
        self.assertEqual(self.count("tree", "z_m IS NULL AND z_sd_m IS NULL"), (ROWS - 1) * TREES)
        self.publish(self.with_heights(self.map_of("hill"), 12.75))
        self.assertEqual(self.count("tree", "z_m = 12.75"), TREES)
        self.assertEqual(self.count("tree_replaced", "z_m = 12.5 AND replaced_at IS NOT NULL"), TREES)
        self.assertEqual(self.count("tree_replaced"), TREES)

    def test_tables_of_before_get_their_heights(self):
        self.publish(self.map_of("hill"))
        self.server.sql("DROP VIEW orchard.tree_now")
        for table in ("tree", "tree_replaced"):  # as they were created once
            self.server.sql(f"ALTER TABLE orchard.{table} DROP COLUMN z_m, DROP COLUMN z_sd_m")
        self.server.sql("CREATE VIEW orchard.tree_now AS SELECT t.* FROM orchard.tree t "
                        "JOIN (SELECT block, max(date) AS date FROM orchard.visit GROUP BY block) v USING (block, date)")
        self.publish(self.with_heights(self.map_of("hill"), 12.5))
        self.assertEqual(self.count("tree_now", "z_m = 12.5"), TREES)
        self.assertEqual(self.count("tree_replaced", "z_m IS NULL AND replaced_at IS NOT NULL"), TREES)

    def test_names_of_people_and_plan(self):
        folder = self.map_of("named")
        with open(folder + "/names.csv", "w") as file:
            file.write('id,row,tree\n101,"A; ""old""",1b\n102,"A; ""old""",2\n')
        self.publish(folder)
        self.assertEqual(self.server.sql("SELECT row_name, tree_name FROM orchard.tree "
                                         "WHERE tree_name IS NOT NULL ORDER BY id"),
                         ['A; "old"|1b', 'A; "old"|2'])
        self.assertEqual(self.count(where="row_name = 'A; \"old\"'"), TREES, "the whole row has its name")
        # Who reads the table learns the map's name, not where its sender keeps it.
        self.assertEqual(self.server.sql("SELECT source FROM orchard.visit"), ["named"])

    SESSIONS = "SELECT count(*) FROM pg_stat_activity WHERE application_name = 'orchard publish'"

    def publisher_in_the_middle(self):
        """A publisher that waits between its COPY and its end, and who holds the table."""
        self.publish(self.map_of("before"))
        holder = subprocess.Popen(["psql", "-X", "-q", "-d", self.server.url()],
                                  stdin=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        holder.stdin.write("BEGIN; LOCK TABLE orchard.tree IN EXCLUSIVE MODE;\n")
        holder.stdin.flush()
        wait_for(lambda: self.server.sql(
            "SELECT count(*) FROM pg_locks WHERE relation = 'orchard.tree'::regclass"
            " AND mode = 'ExclusiveLock' AND granted") == ["1"])
        publisher = subprocess.Popen(self.command(self.map_of("after", lambda row: 0.02, {101})),
                                     stderr=subprocess.PIPE, text=True)
        wait_for(lambda: self.server.sql(self.SESSIONS + " AND wait_event_type = 'Lock'") == ["1"])
        return publisher, holder

    def test_killed_in_the_middle_is_nothing(self):
        publisher, holder = self.publisher_in_the_middle()
        publisher.kill()
        publisher.communicate(timeout=60)
        holder.stdin.close()  # a session that ends takes its lock along
        holder.wait(60)
        wait_for(lambda: self.server.sql(self.SESSIONS) == ["0"])
        self.all_is_as_before()

    def test_a_database_that_dies_in_the_middle_has_nothing_of_it(self):
        publisher, holder = self.publisher_in_the_middle()
        self.server.die()
        _, said = publisher.communicate(timeout=60)
        holder.stdin.close()
        holder.wait(60)
        self.server.start()
        self.assertEqual(publisher.returncode, 1, said)
        self.assertRegex(said, "the connection to the database was lost: .*; nothing was published")
        self.all_is_as_before()
        self.publish(self.map_of("after", lambda row: 0.02, {101}))
        self.assertEqual(self.count(), ROWS * TREES - 1)

    def all_is_as_before(self):
        self.assertEqual(self.count(), ROWS * TREES)
        self.assertEqual(self.count(where="width_m > 0.115"), 0)
        self.assertEqual(self.count("tree_replaced"), 0)

    def test_two_at_once_lose_nothing(self):
        self.server.sql("DROP SCHEMA orchard CASCADE")  # both find no tables
        folders = [self.map_of("one"), self.map_of("two", lambda row: 0.02)]
        publishers = [subprocess.Popen(self.command(folder, block=block))
                      for block in ("north", "south") for folder in folders]
        self.assertEqual([p.wait(120) for p in publishers], [0] * 4)
        for block in ("north", "south"):
            where = f"block = '{block}'"
            self.assertEqual(self.count(where=where), ROWS * TREES)
            widths = {table: self.count(table, where + " AND width_m > 0.115")
                      for table in ("tree", "tree_replaced")}
            # the one that came second stands, the other is kept
            self.assertEqual(sorted(widths.values()), [0, ROWS * TREES])
            self.assertEqual(self.count("tree_replaced", where), ROWS * TREES)

    def test_a_reader_reads_only(self):
        self.publish(self.map_of("read"))
        self.server.sql("CREATE ROLE ana LOGIN; GRANT orchard_reader TO ana")
        self.assertEqual(self.server.sql("SELECT count(*) FROM orchard.tree_now", "ana"),
                         [str(ROWS * TREES)])
        for statement in ("DELETE FROM orchard.tree", "UPDATE orchard.visit SET num_trees = 0"):
            with self.assertRaisesRegex(RuntimeError, "permission denied"):
                self.server.sql(statement, "ana")
        self.server.sql("CREATE ROLE bert LOGIN; GRANT orchard_writer TO bert")
        done = subprocess.run([ORCHARD, "publish", self.map_of("read"), "--to",
                               self.server.url("bert"), "--block", "east", "--date", "2026-05-01"],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_refusals_say_why_and_no_secret(self):
        folder = self.map_of("refused")
        for url, code, words in (("postgresql://ana:tell9nobody@farm/orchard", 3, "~/.pgpass"),
                                 ("host=farm password=tell9nobody", 3, "~/.pgpass"),
                                 ("postgresql://ana:tell9nobody@[farm/orchard", 3, "not a PostgreSQL URL"),
                                 ("postgresql:///orchard?host=/nowhere", 1, "no connection")):
            done = subprocess.run([ORCHARD, "publish", folder, "--to", url, "--block", "north",
                                   "--date", "2026-04-10"], capture_output=True, text=True)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(words, done.stderr)
            self.assertNotIn("tell9nobody", done.stdout + done.stderr)
        for date in ("2026-13-40", "soon"):
            command = self.command(folder)[:-2] + ["--date", date]
            done = subprocess.run(command, capture_output=True, text=True)
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertIn("is not a date", done.stderr)
        self.publish(folder)  # so that there are tables to be emptied


if __name__ == "__main__":
    postgres.programs()
    unittest.main(argv=sys.argv[:1], verbosity=2)

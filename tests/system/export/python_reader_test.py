# SPDX-License-Identifier: BSD-3-Clause
"""scripts/python/orchard_map.py reads what `orchard map` writes as Python's csv and json do.
Usage: python_reader_test.py BIN SOURCE."""
import csv
import json
import os
import subprocess
import sys
import tempfile
import unittest
import warnings

import numpy

ORCHARD = sys.argv[1] + "/orchard"
sys.path.insert(0, os.path.join(sys.argv[2], "scripts/python"))
import orchard_map  # noqa: E402


class Reader(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="orchard_python_")
        log, cls.folder = cls.temporary.name + "/drive.lcm", cls.temporary.name + "/map"
        for words in (["simulate", "--scene", "orchard", "--seed", "2", "--duration", "25", "--out", log],
                      ["map", log, "--out", cls.folder, "--quiet", "--no-derived"]):
            subprocess.run([ORCHARD, *words], check=True, stdout=subprocess.DEVNULL)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def rows(self, name):
        with open(f"{self.folder}/{name}", newline="") as file:
            return list(csv.DictReader(file))

    def test_every_cell(self):
        drive = orchard_map.read(self.folder)
        for name, table in (("map.csv", drive.landmarks), ("trajectory.csv", drive.path)):
            rows = self.rows(name)
            self.assertEqual(len(table), len(rows))
            self.assertGreater(len(rows), 10)
            for row, read in zip(rows, table):
                for column, word in row.items():
                    value = read[column]
                    if word == "":
                        self.assertTrue(value == -1 or numpy.isnan(value), (name, column))
                    elif column == "class":
                        self.assertEqual(value, word)
                    else:
                        self.assertEqual(float(value), float(word), (name, column))
        self.assertEqual(drive.path["utime_us"].dtype, numpy.int64)

    def test_the_graph(self):
        graph = orchard_map.read(self.folder).graph
        with open(self.folder + "/graph.json") as file:
            stored = json.load(file)
        self.assertEqual({n["id"]: n["place"] for n in stored["nodes"]},
                         {id: list(place) for id, place in graph.nodes.items()})
        self.assertEqual(len(graph.edges), len(stored["edges"]))
        self.assertGreater(len(graph.edges), 0)
        for edge, kept in zip(graph.edges, stored["edges"]):
            self.assertEqual(edge.line.tolist(), kept["line"])
            for end, place in ((edge.start, edge.line[0]), (edge.end, edge.line[-1])):
                self.assertTrue(numpy.allclose(graph.nodes[end], place, atol=0.01))

    def test_what_cannot_be_read_is_named(self):
        broken = self.temporary.name + "/broken"
        os.makedirs(broken, exist_ok=True)
        with self.assertRaises(OSError):
            orchard_map.read(broken)
        for text, said in (("id,class,x_m\n1,tree\n", "map.csv:2"), ("id,class,x_m\n1,tree,far\n", "'far'")):
            with open(broken + "/map.csv", "w") as file:
                file.write(text)
            with self.assertRaisesRegex(ValueError, said):
                orchard_map.read(broken)
        with open(broken + "/map.csv", "w") as file:
            file.write("id,class,x_m\n1,tree,2.5\n")
        with open(broken + "/corrections.jsonl", "w") as file:
            file.write("{}\n")
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            self.assertEqual(orchard_map.read(broken).landmarks["x_m"][0], 2.5)
        self.assertIn("not applied", str(caught[0].message))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

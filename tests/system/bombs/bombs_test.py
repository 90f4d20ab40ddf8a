# SPDX-License-Identifier: BSD-3-Clause
"""Files that are made to exhaust or to spy are refused by their limit, and nobody is connected to. Usage:
bombs_test.py BUILD. How long each takes is measured by bombs.py, not tested."""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import bombs  # noqa: E402

ORCHARD = os.path.join(sys.argv[1], "bin/orchard")
# What refuses each: a limit that counts, or the reader's own.
REFUSALS = {
    "geojson_link": "could not be read completely",
    "geojson_url": "could not be read completely",
    "geojson_name_url": "could not be read completely",
    "geojson_name_file": "could not be read completely",
    "gpkg_url": "could not be read completely",
    "geojson_deep": "Too many nested",
    "kml_entities": "parsing aborted",
    "kmz_places": "unpacks to 870000092",
    "dxf_copies": "features of as many bytes",
    "gpkg_view": "features of as many bytes",
    "mcap_zstd": "no recording packs so well",
    "rosbag_bz2": "no recording packs so well",
    "rosbag_messages": "a chunk of more than 128 MB",
    "mcap_scans": "chunks unpack to over",
    "rosbag2_zstd": "no recording packs so well",
    "rosbag2_column": "not stored but computed",
    "rosbag2_view": "not stored but computed",
    "csv_gzip": "a line of over 1 MB",
    "csv_gzip_lines": "is not later than",
    "yaml_plan": "must be a whole number",
    "yaml_recording": "must be a section",
    "yaml_deep": "is not valid YAML",
    "lcm_size": "has no LCM event",
}


class Bombs(unittest.TestCase):
    def test_are_refused_and_nobody_is_asked(self):
        for name, reason in REFUSALS.items():
            with self.subTest(name):
                result = bombs.run(ORCHARD, name)
                self.assertEqual(result.code, 3, result.said)
                self.assertIn(reason, result.said)
                self.assertEqual(result.connections, 0)

    def test_the_server_counts_who_connects(self):
        server = bombs.Server()
        with bombs.socket.create_connection(server.socket.getsockname()) as connection:
            connection.recv(1)
        server.close()
        self.assertEqual(server.connections, 1)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)

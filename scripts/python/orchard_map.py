# SPDX-License-Identifier: BSD-3-Clause
"""Reads map folders of Orchard Mapper as numpy arrays; lengths in metres, angles in radians, in the frame map.

    import orchard_map
    drive = orchard_map.read("out/drive")
    trees = drive.landmarks[drive.landmarks["class"] == "tree"]
    print(trees["x_m"].mean(), drive.path["yaw_rad"][-1], drive.graph.edges[0].line)

Corrections made by hand are not applied: `orchard export out/drive --format csv` writes the corrected map.
"""
import json
import pathlib
import typing
import warnings

import numpy

_WORDS = {"class": "U8", "id": "i4", "n": "i4", "row": "i4", "position": "i4", "utime_us": "i8"}


class Edge(typing.NamedTuple):
    """An aisle or headland path, which can be driven in both directions."""

    id: int
    kind: str  # "aisle" or "headland"
    start: int  # ids of nodes
    end: int
    width_m: float  # free width at the narrowest point
    line: numpy.ndarray  # N x 2, in map


class Graph(typing.NamedTuple):
    nodes: dict  # place (2) by id
    edges: list


class Map(typing.NamedTuple):
    landmarks: numpy.ndarray  # structured, the columns of map.csv; -1 and NaN where a number is unknown
    paths: list  # of each drive: structured, utime_us, x_m, y_m, yaw_rad
    graph: Graph

    @property
    def path(self):
        """The path of the first drive."""
        return self.paths[0]


def read_table(path):
    """A CSV of a map folder as a structured array. Raises ValueError naming file and line."""
    with open(path, encoding="utf-8") as file:
        names = file.readline().strip().split(",")
        types = [(name, _WORDS.get(name, "f8")) for name in names]
        rows = []
        for number, line in enumerate(file, 2):
            words = line.rstrip("\n").split(",")
            if len(words) != len(names):
                raise ValueError(f"{path}:{number}: {len(words)} columns, but the first line names {len(names)}")
            try:
                rows.append(tuple(_value(word, kind) for word, (_, kind) in zip(words, types)))
            except ValueError as error:
                raise ValueError(f"{path}:{number}: {error}") from None
    return numpy.array(rows, dtype=types)


def _value(word, kind):
    if kind.startswith("U"):
        return word
    if kind.startswith("i"):
        return int(word) if word else -1
    return float(word) if word else numpy.nan


def _read_graph(path):
    if not path.exists():
        return Graph({}, [])
    stored = json.loads(path.read_text(encoding="utf-8"))
    nodes = {node["id"]: numpy.array(node["place"]) for node in stored["nodes"]}
    edges = [Edge(e["id"], e["kind"], e["from"], e["to"], e["width_m"], numpy.array(e["line"]))
             for e in stored["edges"]]
    return Graph(nodes, edges)


def read(folder):
    """Reads a map folder. Raises OSError for a missing map.csv, ValueError for an invalid file."""
    folder = pathlib.Path(folder)
    corrections = folder / "corrections.jsonl"
    if corrections.exists() and corrections.stat().st_size > 0:
        warnings.warn(f"{corrections} is not applied; see orchard_map's help", stacklevel=2)
    paths = [path for path in [folder / "trajectory.csv"] if path.exists()]
    while paths and (more := folder / f"trajectory_{len(paths) + 1}.csv").exists():
        paths.append(more)
    return Map(read_table(folder / "map.csv"), [read_table(path) for path in paths],
               _read_graph(folder / "graph.json"))

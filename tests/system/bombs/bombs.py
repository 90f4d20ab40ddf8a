#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Files that are made to exhaust or to spy on who reads them: small, and huge when they are unpacked, copied
or followed. Each is read by the command that a user would give it to; what it cost is printed.

A bomb is defused when the command ends by itself within the limits, or within a second of SIGTERM, and
nothing connected to the listening server that some of them name.
"""
import argparse
import bz2
import ctypes
import ctypes.util
import gzip
import json
import os
import shutil
import signal
import socket
import sqlite3
import struct
import subprocess
import sys
import tempfile
import threading
import time
import zipfile
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import maps  # noqa: E402

MIB = 1 << 20
BOMBS = {}  # name: (what it is, function(folder, url) -> words after `orchard`)


def bomb(what):
    def add(function):
        BOMBS[function.__name__] = (what, function)
        return function
    return add


def written(folder, name, content):
    path = os.path.join(folder, name)
    with open(path, "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())
    return path


def lz4(content):
    """A frame of lz4, by the library itself."""
    library = ctypes.CDLL(ctypes.util.find_library("lz4"))
    library.LZ4F_compressFrameBound.restype = library.LZ4F_compressFrame.restype = ctypes.c_size_t
    library.LZ4F_compressFrameBound.argtypes = [ctypes.c_size_t, ctypes.c_void_p]
    library.LZ4F_compressFrame.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_size_t, ctypes.c_void_p]
    out = ctypes.create_string_buffer(library.LZ4F_compressFrameBound(len(content), None))
    size = library.LZ4F_compressFrame(out, len(out), content, len(content), None)
    return out.raw[:size]


def zstd(content):
    """A frame of zstd that states its content's size, by the library itself."""
    library = ctypes.CDLL(ctypes.util.find_library("zstd"))
    library.ZSTD_compressBound.restype = library.ZSTD_compress.restype = ctypes.c_size_t
    library.ZSTD_compressBound.argtypes = [ctypes.c_size_t]
    library.ZSTD_compress.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_size_t, ctypes.c_int]
    out = ctypes.create_string_buffer(library.ZSTD_compressBound(len(content)))
    size = library.ZSTD_compress(out, len(out), content, len(content), 3)
    return out.raw[:size]


# --- A grower's plan, read by GDAL ---

def geojson(crs):
    point = {"type": "Feature", "properties": {"row": "1"}, "geometry": {"type": "Point", "coordinates": [1.0, 41.0]}}
    return json.dumps({"type": "FeatureCollection", "crs": crs, "features": [point]})


@bomb("a coordinate system that is a link")
def geojson_link(folder, url):
    crs = {"type": "link", "properties": {"href": url, "type": "ogcwkt"}}
    return ["plan", written(folder, "plan.geojson", geojson(crs)), "--csv"]


@bomb("a coordinate system that is a URL")
def geojson_url(folder, url):
    return ["plan", written(folder, "plan.geojson", geojson({"type": "url", "properties": {"url": url}})), "--csv"]


@bomb("a coordinate system whose name is a URL")
def geojson_name_url(folder, url):
    return ["plan", written(folder, "plan.geojson", geojson({"type": "name", "properties": {"name": url}})), "--csv"]


@bomb("a coordinate system whose name is a file")
def geojson_name_file(folder, url):
    other = written(folder, "other.wkt", 'LOCAL_CS["spied"]')
    return ["plan", written(folder, "plan.geojson", geojson({"type": "name", "properties": {"name": other}})), "--csv"]


@bomb("200,000 lists within each other")
def geojson_deep(folder, url):
    text = '{"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":'
    return ["plan", written(folder, "plan.geojson", text + "[" * 200000 + "]" * 200000 + "}}]}"), "--csv"]


KML = '<?xml version="1.0"?>%s<kml xmlns="http://www.opengis.net/kml/2.2"><Document>%s</Document></kml>'
PLACE = "<Placemark><name>1</name>%s<Point><coordinates>1.0,41.0</coordinates></Point></Placemark>"


@bomb("network links, icons and styles on a server")
def kml_links(folder, url):
    links = f"<NetworkLink><Link><href>{url}</href></Link></NetworkLink>" + PLACE % f"<styleUrl>{url}#a</styleUrl>"
    overlay = f"<GroundOverlay><Icon><href>{url}</href></Icon></GroundOverlay>"
    return ["plan", written(folder, "plan.kml", KML % ("", links + overlay)), "--csv"]


@bomb("entities of entities")
def kml_entities(folder, url):
    entities = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 12))
    text = KML % (f'<!DOCTYPE kml [<!ENTITY e0 "laughs">{entities}]>', "<name>&e11;</name>" + PLACE % "")
    return ["plan", written(folder, "plan.kml", text), "--csv"]


@bomb("20,000 folders within each other")
def kml_deep(folder, url):
    return ["plan", written(folder, "plan.kml", KML % ("", "<Folder>" * 20000 + PLACE % "" + "</Folder>" * 20000)), "--csv"]


def zipped(folder, name, inside, megabytes, head=b"", tail=b""):
    path = os.path.join(folder, name)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        with archive.open(inside, "w", force_zip64=True) as file:
            file.write(head)
            for _ in range(megabytes):
                file.write(b" " * MIB)
            file.write(tail)
    return path


@bomb("1.6 GB of blanks, zipped")
def kmz_blanks(folder, url):
    begin, end = (KML % ("", "@" + PLACE % "")).split("@")
    return ["plan", zipped(folder, "plan.kmz", "doc.kml", 1600, begin.encode(), end.encode()), "--csv"]


@bomb("10 million places, zipped")
def kmz_places(folder, url):
    path = os.path.join(folder, "plan.kmz")
    begin, end = (KML % ("", "@")).split("@")
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive, archive.open("doc.kml", "w", force_zip64=True) as file:
        file.write(begin.encode())
        for _ in range(1000):
            file.write((PLACE % "").encode() * 10000)
        file.write(end.encode())
    return ["plan", path, "--csv"]


@bomb("a shapefile of 1.6 GB of zeros, zipped")
def shp_zip(folder, url):
    path = os.path.join(folder, "plan.shp.zip")
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        head = struct.pack(">I20xI", 9994, 800 * MIB) + struct.pack("<II8d", 1000, 1, 0, 0, 1, 1, 0, 0, 0, 0)
        for name in ("plan.shp", "plan.shx"):
            with archive.open(name, "w", force_zip64=True) as file:
                file.write(head)
                for _ in range(1600):
                    file.write(bytes(MIB))
    return ["plan", path, "--csv"]


@bomb("an index of 250 million shapes that is a hole of 2 GB")
def shp_hole(folder, url):
    head = struct.pack(">I20xI", 9994, 2**30 - 50) + struct.pack("<II8d", 1000, 1, 0, 0, 1, 1, 0, 0, 0, 0)
    for name in ("plan.shp", "plan.shx"):
        os.truncate(written(folder, name, head), 2**31 - 100)
    return ["plan", os.path.join(folder, "plan.shp"), "--csv"]


def dxf(blocks, entities):
    return f"0\nSECTION\n2\nHEADER\n0\nENDSEC\n0\nSECTION\n2\nBLOCKS\n{blocks}0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n"


@bomb("an insert of two thousand million copies")
def dxf_copies(folder, url):
    block = "0\nBLOCK\n8\n0\n2\nA\n10\n0\n20\n0\n0\nPOINT\n8\n0\n10\n1\n20\n1\n0\nENDBLK\n"
    return ["plan", written(folder, "plan.dxf", dxf(block, "0\nINSERT\n8\n0\n2\nA\n10\n0\n20\n0\n70\n45000\n71\n45000\n44\n1\n45\n1\n")),
            "--csv", "--crs", "EPSG:25830"]


@bomb("blocks of blocks: 10^12 copies")
def dxf_blocks(folder, url):
    insert = "0\nINSERT\n8\n0\n2\n%s\n10\n%d\n20\n0\n"
    blocks = "0\nBLOCK\n8\n0\n2\nB0\n10\n0\n20\n0\n0\nLINE\n8\n0\n10\n1\n20\n1\n11\n2\n21\n2\n0\nENDBLK\n"
    for k in range(1, 13):
        blocks += f"0\nBLOCK\n8\n0\n2\nB{k}\n10\n0\n20\n0\n" + "".join(insert % (f"B{k - 1}", j) for j in range(10)) + "0\nENDBLK\n"
    return ["plan", written(folder, "plan.dxf", dxf(blocks, insert % ("B12", 0))), "--csv", "--crs", "EPSG:25830"]


def geopackage(path, extra, system="GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],"
               "UNIT[\"degree\",0.0174532925199433]]", organization="EPSG"):
    with sqlite3.connect(path) as database:
        database.executescript("""
            PRAGMA application_id=0x47504B47; PRAGMA user_version=10200;
            CREATE TABLE gpkg_spatial_ref_sys(srs_name TEXT NOT NULL, srs_id INTEGER PRIMARY KEY, organization TEXT NOT NULL,
              organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);
            CREATE TABLE gpkg_contents(table_name TEXT PRIMARY KEY, data_type TEXT, identifier TEXT, description TEXT, last_change,
              min_x, min_y, max_x, max_y, srs_id INTEGER);
            CREATE TABLE gpkg_geometry_columns(table_name TEXT, column_name TEXT, geometry_type_name TEXT, srs_id INTEGER, z, m);
            INSERT INTO gpkg_contents VALUES('trees','features','trees','','2026-01-01T00:00:00Z',0,0,1,1,9);
            INSERT INTO gpkg_geometry_columns VALUES('trees','geom','POINT',9,0,0);""")
        database.execute("INSERT INTO gpkg_spatial_ref_sys VALUES('s',9,?,9999,?,'')", (organization, system))
        database.executescript(extra)
    database.close()
    return path


POINT = "x'47500001090000000101000000000000000000F03F0000000000804440'"


@bomb("a layer that is a query without end")
def gpkg_view(folder, url):
    view = f"CREATE VIEW trees AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i+1 FROM n) SELECT i AS fid, {POINT} AS geom FROM n;"
    return ["plan", geopackage(os.path.join(folder, "plan.gpkg"), view), "--csv"]


@bomb("a column that fills the memory")
def gpkg_column(folder, url):
    table = (f"CREATE TABLE trees(fid INTEGER PRIMARY KEY, geom BLOB, row TEXT AS (hex(zeroblob(400000000))));"
             f"INSERT INTO trees(fid,geom) VALUES(1,{POINT});")
    return ["plan", geopackage(os.path.join(folder, "plan.gpkg"), table), "--csv"]


@bomb("a coordinate system that is a URL")
def gpkg_url(folder, url):
    table = f"CREATE TABLE trees(fid INTEGER PRIMARY KEY, geom BLOB);INSERT INTO trees VALUES(1,{POINT});"
    return ["plan", geopackage(os.path.join(folder, "plan.gpkg"), table, url, "none"), "--csv"]


@bomb("a line of 2 GB")
def csv_line(folder, url):
    path = written(folder, "plan.csv", "longitude,latitude\n1.0,")
    os.truncate(path, 2**31)
    return ["plan", path, "--csv"]


@bomb("100,000 columns and 20,000 empty lines of them")
def csv_columns(folder, url):
    columns = "longitude,latitude" + "".join(f",c{k}" for k in range(100000))
    return ["plan", written(folder, "plan.csv", columns + "\n" + "1.0,41.0\n" * 20000), "--csv"]


@bomb("a header that counts 2^60 features")
def fgb_counts(folder, url):
    return ["plan", written(folder, "plan.fgb", b"fgb\x03fgb\x00" + struct.pack("<I", 2**31 - 1) + b"\xff" * 4000), "--csv"]


# --- Recordings ---

def imported(folder, path):
    return ["import", path, "--out", os.path.join(folder, "out.lcm")]


def ros1_record(fields, data):
    header = b"".join(struct.pack("<I", len(field)) + field for field in (name + b"=" + value for name, value in fields))
    return struct.pack("<I", len(header)) + header + struct.pack("<I", len(data)) + data


def ros1_chunk(packing, packed, size):
    return ros1_record([(b"op", b"\5"), (b"compression", packing), (b"size", struct.pack("<I", size))], packed)


@bomb("60 chunks of 230 MB each, bz2")
def rosbag_bz2(folder, url):
    content = ros1_record([(b"op", b"\3")], bytes(230 * MIB))
    chunk = ros1_chunk(b"bz2", bz2.compress(content), len(content))
    return imported(folder, written(folder, "a.bag", b"#ROSBAG V2.0\n" + chunk * 60))


@bomb("messages of no topic, 20 chunks of 200 MB, lz4")
def rosbag_messages(folder, url):
    record = ros1_record([(b"op", b"\2"), (b"conn", bytes(4)), (b"time", bytes(8))], b"")
    content = record * (200 * MIB // len(record))
    chunk = ros1_chunk(b"lz4", lz4(content), len(content))
    return imported(folder, written(folder, "a.bag", b"#ROSBAG V2.0\n" + chunk * 20))


@bomb("2 million beginnings of records without an end")
def rosbag_damage(folder, url):
    return imported(folder, written(folder, "a.bag", b"#ROSBAG V2.0\n" + struct.pack("<I", 200) * 2000000))


def mcap_record(opcode, content):
    return struct.pack("<BQ", opcode, len(content)) + content


def mcap_chunk(packing, packed, size):
    return mcap_record(6, struct.pack("<QQQII", 0, 0, size, 0, len(packing)) + packing + struct.pack("<Q", len(packed)) + packed)


@bomb("60 chunks of 100 MB each, zstd")
def mcap_zstd(folder, url):
    content = mcap_record(0x80, b"") * (100 * MIB // 9)
    chunk = mcap_chunk(b"zstd", zstd(content), len(content))
    return imported(folder, written(folder, "a.mcap", b"\x89MCAP0\r\n" + chunk * 60))


@bomb("scans in 200 chunks of 30 MB each, zstd")
def mcap_scans(folder, url):
    scan = struct.pack("<IiII", 0x00000100, 1, 0, 1) + bytes(24) + struct.pack("<I", 100) + bytes(400) + bytes(8)
    channel = mcap_record(3, struct.pack("<H", 1) + text(b"sensor_msgs/msg/LaserScan") + text(b"ros2msg") + text(b""))
    channel += mcap_record(4, struct.pack("<HH", 1, 1) + text(b"/scan") + text(b"cdr") + struct.pack("<I", 0))
    message = mcap_record(5, struct.pack("<HIQQ", 1, 0, 10**9, 10**9) + scan)
    content = channel + message * (30 * MIB // len(message))
    chunk = mcap_chunk(b"zstd", zstd(content), len(content))
    return imported(folder, written(folder, "a.mcap", b"\x89MCAP0\r\n" + chunk * 200))


def text(value):
    return struct.pack("<I", len(value)) + value


def rosbag2(path, messages):
    with sqlite3.connect(path) as database:
        database.executescript("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);"
                               "INSERT INTO topics VALUES(1,'/scan','sensor_msgs/msg/LaserScan','cdr');")
        messages(database)
    database.close()
    return path


PLAIN_MESSAGES = "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);"


@bomb("300 messages of 60 MB each, zstd")
def rosbag2_zstd(folder, url):
    def messages(database):
        database.execute(PLAIN_MESSAGES)
        packed = zstd(bytes(60 * MIB))
        database.executemany("INSERT INTO messages VALUES(?,1,?,?)", [(k, k, packed) for k in range(1, 301)])
    return imported(folder, rosbag2(os.path.join(folder, "a.db3"), messages))


@bomb("5,000 rows that make 60 MB each when they are read")
def rosbag2_column(folder, url):
    def messages(database):
        database.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER)")
        database.executemany("INSERT INTO messages VALUES(?,1,?)", [(k, k) for k in range(1, 5001)])
        database.execute("ALTER TABLE messages ADD COLUMN data BLOB AS (replace(hex(zeroblob(15000000)),'00','0123'))")
    return imported(folder, rosbag2(os.path.join(folder, "a.db3"), messages))


@bomb("a table of messages that is a query without end")
def rosbag2_view(folder, url):
    return imported(folder, rosbag2(os.path.join(folder, "a.db3"), lambda database: database.execute(
        "CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i+1 FROM n)"
        " SELECT i AS rowid, 1 AS topic_id, i AS timestamp, x'00' AS data FROM n WHERE i < 0")))


@bomb("a rawlog of 1.6 GB of zeros")
def rawlog_gzip(folder, url):
    path = os.path.join(folder, "a.rawlog")
    with gzip.open(path, "wb") as file:
        for _ in range(1600):
            file.write(bytes(MIB))
    return imported(folder, path)


def recording(folder, yaml=None):
    path = os.path.join(folder, "recording")
    os.makedirs(path)
    written(path, "sensors.yaml", yaml or "laser: {num_beams: 1, bearing_min_rad: 0, bearing_step_rad: 0.1, range_min_m: 0.1, range_max_m: 30}\n")
    return path


@bomb("a recording's scans, 1.6 GB of one line")
def csv_gzip(folder, url):
    path = recording(folder)
    with gzip.open(os.path.join(path, "scans.csv.gz"), "wb") as file:
        file.write(b"utime_us,r0\n")
        for _ in range(1600):
            file.write(b"1" * MIB)
    return imported(folder, path)


@bomb("a recording's scans, 100 million lines of 1.6 MB")
def csv_gzip_lines(folder, url):
    path = recording(folder)
    packer = zlib.compressobj(9, zlib.DEFLATED, 31)
    with open(os.path.join(path, "scans.csv.gz"), "wb") as file:
        file.write(packer.compress(b"utime_us,r0\n"))
        lines = b"1,1.0\n" * 1000000
        for _ in range(100):
            file.write(packer.compress(lines))
        file.write(packer.flush())
    return imported(folder, path)


LAUGHS = "a0: &a0 [x,x,x,x,x,x,x,x,x,x]\n" + "".join(f"a{k}: &a{k} [{','.join([f'*a{k - 1}'] * 10)}]\n" for k in range(1, 12))


@bomb("aliases of aliases in a recording's description")
def yaml_recording(folder, url):
    return imported(folder, recording(folder, LAUGHS + "laser: *a11\n"))


@bomb("aliases of aliases in a plan")
def yaml_plan(folder, url):
    return ["plan", written(folder, "plan.yaml", LAUGHS + "rows: *a11\ncorner_deg: *a11\n"), "--csv"]


def rigged(folder, yaml):
    return ["map", written(folder, "a.lcm", b""), "--config", written(folder, "rig.yaml", yaml), "--out", os.path.join(folder, "map")]


@bomb("aliases of aliases in a rig")
def yaml_rig(folder, url):
    return rigged(folder, LAUGHS + "laser: *a11\ncamera: *a11\n")


@bomb("100,000 lists within each other in a rig")
def yaml_deep(folder, url):
    return rigged(folder, "laser: " + "[" * 100000 + "]" * 100000 + "\n")


def png(width, height):
    def part(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
    packer = zlib.compressobj(9)
    rows = b"".join(packer.compress(bytes(1 + 3 * width)) for _ in range(height)) + packer.flush()
    return b"\x89PNG\r\n\x1a\n" + part(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) + part(b"IDAT", rows) + part(b"IEND", b"")


def jpeg(width, height, scans):
    """A progressive JPEG of that many passes, each of which says that every block stays as it is."""
    def part(kind, content):
        return b"\xff" + bytes([kind]) + struct.pack(">H", len(content) + 2) + content
    table = part(0xC4, bytes([0x10, 1]) + bytes(15) + b"\xe0") + part(0xC4, bytes([0, 1]) + bytes(15) + b"\0")
    begin = b"\xff\xd8" + part(0xDB, b"\0" + b"\1" * 64) + part(0xC2, struct.pack(">BHHB", 8, height, width, 1) + bytes([1, 0x11, 0])) + table
    # a run of 32,767 empty blocks: symbol 0xE0 and 14 bits
    blocks = (width // 8) * (height // 8)
    runs = bytes(2 * (blocks // 16384 + 1))
    return begin + (part(0xDA, bytes([1, 1, 0, 1, 63, 0])) + runs) * scans + b"\xff\xd9"


def photographs(folder, picture, ending):
    for name in ("pictures", "masks"):
        os.makedirs(os.path.join(folder, name))
        written(os.path.join(folder, name), "000" + ending, picture)
    return ["calibrate", "trunks", "--images", os.path.join(folder, "pictures"), "--masks", os.path.join(folder, "masks"),
            "--out", os.path.join(folder, "model.yaml")]


@bomb("a picture of 8192 x 8192 in 200 kB")
def png_large(folder, url):
    return photographs(folder, png(8192, 8192), ".png")


@bomb("a picture of 8192 x 8192 of 5,000 passes")
def jpeg_passes(folder, url):
    return photographs(folder, jpeg(8192, 8192, 5000), ".jpg")


@bomb("300 pictures of 8192 x 8192 in a bag")
def mcap_png(folder, url):
    schema = mcap_record(3, struct.pack("<H", 1) + text(b"sensor_msgs/msg/CompressedImage") + text(b"ros2msg") + text(b""))
    channel = mcap_record(4, struct.pack("<HH", 1, 1) + text(b"/image") + text(b"cdr") + struct.pack("<I", 0))
    picture = png(8192, 8192)
    content = schema + channel
    for k in range(300):
        message = struct.pack("<IiII", 0x00000100, 1 + k, 0, 1) + bytes(4) + struct.pack("<I", 4) + b"png\0" + struct.pack("<I", len(picture)) + picture
        content += mcap_record(5, struct.pack("<HIQQ", 1, k, 10**9 * (1 + k), 10**9 * (1 + k)) + message)
    return imported(folder, written(folder, "a.mcap", b"\x89MCAP0\r\n" + content))


# --- Maps of others ---

@bomb("100,000 lists within each other in a map's summary")
def json_deep(folder, url):
    path = maps.write_map(os.path.join(folder, "map"), [maps.landmark(1, 0, 0)])
    written(path, "summary.json", '{"georeference": ' + "[" * 100000 + "]" * 100000 + "}")
    return ["report", path, "--out", os.path.join(folder, "report")]


@bomb("a log whose only event is said to have 2 GB")
def lcm_size(folder, url):
    return ["log", "info", written(folder, "a.lcm", struct.pack(">IQQII", 0xEDA1DA01, 0, 1, 4, 2**31 - 1) + b"SCAN" + bytes(1000))]


class Server:
    """Listens, and counts who connects."""

    def __init__(self):
        self.connections = 0
        self.socket = socket.create_server(("127.0.0.1", 0))
        self.url = f"http://127.0.0.1:{self.socket.getsockname()[1]}/crs"
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self):
        while True:
            try:
                connection, _ = self.socket.accept()
            except OSError:
                return
            self.connections += 1
            connection.close()

    def close(self):
        self.socket.close()


def own_mib(pid):
    """Resident memory that the process does not share with its parent."""
    try:
        with open(f"/proc/{pid}/smaps_rollup") as file:
            fields = dict(line.split(":") for line in file.read().split("\n")[1:] if ":" in line)
        return sum(int(fields[name].split()[0]) for name in ("Private_Clean", "Private_Dirty")) / 1024
    except (OSError, KeyError):
        return 0


def memory_mib(pid):
    """The resident memory of a process and its children together, each at its highest so far."""
    total = 0
    try:
        with open(f"/proc/{pid}/status") as file:
            total = int(file.read().split("VmHWM:")[1].split()[0]) / 1024
        with open(f"/proc/{pid}/task/{pid}/children") as file:
            total += sum(own_mib(int(child)) for child in file.read().split())
    except (OSError, IndexError):
        pass
    return total


class Result:
    """What a command made of a bomb."""

    def __init__(self):
        self.code, self.seconds, self.mib, self.stop_seconds, self.connections, self.said = None, 0.0, 0.0, None, 0, ""


def run(orchard, name, seconds=None, strace=None):
    """Gives the bomb to the command. `seconds`: SIGTERM after so many; None: waits for its end."""
    result = Result()
    folder = tempfile.mkdtemp(prefix="orchard_bomb_")
    server = Server()
    try:
        words = [orchard] + BOMBS[name][1](folder, server.url)
        if strace:
            words = ["strace", "-f", "-o", strace, "-e", "trace=openat,connect,socket,execve"] + words
        begin = time.monotonic()
        with open(os.path.join(folder, "said"), "wb") as said:
            process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=said, stderr=said)
        stopped = None
        while process.poll() is None:
            result.mib = max(result.mib, memory_mib(process.pid))
            if seconds is not None and stopped is None and time.monotonic() > begin + seconds:
                stopped = time.monotonic()
                process.send_signal(signal.SIGTERM)
            if stopped is not None and time.monotonic() > stopped + 10:
                process.kill()
            time.sleep(0.005)
        end = time.monotonic()
        result.seconds, result.code = end - begin, process.returncode
        if stopped is not None:
            result.stop_seconds = end - stopped
        result.connections = server.connections
        with open(os.path.join(folder, "said"), errors="replace") as file:
            result.said = file.read().strip().replace(folder + "/", "")
    finally:
        server.close()
        shutil.rmtree(folder)
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../build"),
                        help="the build whose bin/orchard is tried (default: build beside tests)")
    parser.add_argument("--seconds", type=float, default=5.0, help="after which a command is asked to end (default: 5)")
    parser.add_argument("--mib", type=float, default=200.0, help="memory that a command may take (default: 200)")
    parser.add_argument("--say", action="store_true", help="what each command said")
    parser.add_argument("names", nargs="*", metavar="BOMB", help="only these: " + ", ".join(BOMBS))
    arguments = parser.parse_args()
    missed = 0
    print(f"{'bomb':<20} {'code':>4} {'s':>6} {'MiB':>6} {'stop s':>7} {'connections':>11}")
    for name in arguments.names or BOMBS:
        result = run(os.path.join(arguments.build, "bin/orchard"), name, arguments.seconds)
        is_met = (result.code is not None and result.code >= 0 or result.stop_seconds is not None) and result.mib <= arguments.mib
        is_met = is_met and (result.stop_seconds or 0.0) <= 1.0 and result.connections == 0
        missed += not is_met
        stop = "" if result.stop_seconds is None else f"{result.stop_seconds:.2f}"
        print(f"{name:<20} {result.code:>4} {result.seconds:>6.2f} {result.mib:>6.0f} {stop:>7} {result.connections:>11}"
              f"  {'' if is_met else 'MISSED: '}{BOMBS[name][0]}", flush=True)
        if arguments.say:
            print("    " + result.said[:400].replace("\n", "\n    "))
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: BSD-3-Clause
import struct


def events(path):
    """(channel, bytes) of each event of an LCM log."""
    with open(path, "rb") as file:
        data = file.read()
    at = 0
    while at < len(data):
        sync, _, _, num_name, num_data = struct.unpack_from(">IqqII", data, at)
        assert sync == 0xEDA1DA01, at
        at += 28
        yield data[at:at + num_name].decode(), data[at + num_name:at + num_name + num_data]
        at += num_name + num_data

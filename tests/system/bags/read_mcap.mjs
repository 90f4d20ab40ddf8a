// SPDX-License-Identifier: BSD-3-Clause
// node read_mcap.mjs FILE: reads an MCAP of ROS 2 by its index with @mcap/core, its messages with
// @foxglove/rosmsg2-serialization by the definitions in the file, and prints one line of JSON a message:
// [topic, type, time_ns, message]. Exits 1 at what does not hold.
import { execFileSync } from "node:child_process";
import { open } from "node:fs/promises";
import { McapIndexedReader } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import { ros2humble } from "@foxglove/rosmsg-msgs-common";
import { MessageReader } from "@foxglove/rosmsg2-serialization";

const file = await open(process.argv[2]);
const readable = {
  size: async () => BigInt((await file.stat()).size),
  read: async (offset, size) => {
    const bytes = new Uint8Array(Number(size));
    await file.read(bytes, 0, Number(size), Number(offset));
    return bytes;
  },
};
const zstd = (bytes) => execFileSync("zstd", ["-d", "-q", "-c"], { input: bytes, maxBuffer: 1 << 28 });
const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers: { zstd } });
if (reader.header.profile !== "ros2") throw new Error(`profile ${reader.header.profile}`);

// A type's fields, without comments and constants, must be those of ROS 2 Humble.
const shape = (fields) =>
  JSON.stringify(fields.filter((f) => !f.isConstant).map((f) => [f.name, f.type, !!f.isArray, f.arrayLength ?? 0]));
function check(definitions, name) {
  for (const { name: type, definitions: fields } of definitions) {
    const official = ros2humble[(type ?? name).replace("/msg/", "/")];
    if (!official) throw new Error(`ROS 2 knows no ${type ?? name}`);
    if (shape(official.definitions).replaceAll("/msg/", "/") !== shape(fields).replaceAll("/msg/", "/")) {
      throw new Error(`${type ?? name} is not that of ROS 2: ${shape(fields)}`);
    }
  }
}

const plain = (key, value) =>
  typeof value === "bigint" ? Number(value)
  : value instanceof Uint8Array ? { base64: Buffer.from(value).toString("base64") }
  : ArrayBuffer.isView(value) ? Array.from(value, (v) => plain(key, v))
  : value === Infinity ? "inf" : Number.isNaN(value) ? "nan" : value;
const readers = new Map();
let last = -1n, count = 0n;
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  if (channel.messageEncoding !== "cdr" || schema.encoding !== "ros2msg") throw new Error("not ROS 2");
  if (!channel.metadata.has("offered_qos_profiles")) throw new Error("rosbag2 wants a profile");
  if (!readers.has(schema.name)) {
    const definitions = parse(Buffer.from(schema.data).toString(), { ros2: true });
    check(definitions, schema.name);
    readers.set(schema.name, new MessageReader(definitions));
  }
  const value = readers.get(schema.name).readMessage(message.data);
  if (message.logTime < last) throw new Error("the index is not in order of time");
  last = message.logTime;
  ++count;
  process.stdout.write(
    JSON.stringify([channel.topic, schema.name, String(message.logTime), value], plain) + "\n");
}
if (count !== reader.statistics.messageCount) throw new Error("the summary counts otherwise");

// SPDX-License-Identifier: BSD-3-Clause
// node read_mcap.mjs FILE: reads an MCAP by its index with @mcap/core and prints one line of JSON a
// message: [topic, time_ns, message]. Every message is checked against Foxglove's own JSON schema of
// its name (@foxglove/schemas), and against the one in the file. Exits 1 at what does not hold.
import { execFileSync } from "node:child_process";
import { open } from "node:fs/promises";
import Ajv from "ajv";
import { createRequire } from "node:module";
import { McapIndexedReader } from "@mcap/core";

const schemas = createRequire(import.meta.url)("@foxglove/schemas/jsonschema");
const ajv = new Ajv({ strict: false, validateFormats: false });
const official = (name) => schemas[name.replace("foxglove.", "")];
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
const checks = new Map();
let last = -1n, count = 0n;
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  if (!checks.has(schema.name)) {
    const own = JSON.parse(Buffer.from(schema.data).toString());
    const theirs = schema.name.startsWith("foxglove.") ? official(schema.name) : own;
    if (!theirs) throw new Error(`Foxglove knows no schema ${schema.name}`);
    checks.set(schema.name, [ajv.compile(own), ajv.compile(theirs)]);
  }
  const value = JSON.parse(Buffer.from(message.data).toString());
  for (const check of checks.get(schema.name)) {
    if (!check(value)) throw new Error(`${channel.topic}: ${JSON.stringify(check.errors[0])}`);
  }
  if (message.logTime < last) throw new Error("the index is not in order of time");
  last = message.logTime;
  ++count;
  process.stdout.write(JSON.stringify([channel.topic, String(message.logTime), value]) + "\n");
}
if (count !== reader.statistics.messageCount) throw new Error("the summary counts otherwise");

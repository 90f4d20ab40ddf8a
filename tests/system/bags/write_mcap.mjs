// SPDX-License-Identifier: BSD-3-Clause
// node write_mcap.mjs FILE none|zstd|lz4: reads lines [time_ns, topic, type, fields] and writes them
// as MCAP, by @mcap/core and @foxglove/rosmsg2-serialization.
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { open } from "node:fs/promises";
import { McapWriter } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import { MessageWriter } from "@foxglove/rosmsg2-serialization";

const vector = "geometry_msgs/Vector3", point = "geometry_msgs/Point";
const parts = {
  "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id",
  "builtin_interfaces/Time": "int32 sec\nuint32 nanosec",
  [vector]: "float64 x\nfloat64 y\nfloat64 z",
  [point]: "float64 x\nfloat64 y\nfloat64 z",
  "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w",
  "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation",
  "geometry_msgs/PoseWithCovariance": "geometry_msgs/Pose pose\nfloat64[36] covariance",
  "geometry_msgs/Twist": `${vector} linear\n${vector} angular`,
  "geometry_msgs/TwistWithCovariance": "geometry_msgs/Twist twist\nfloat64[36] covariance",
  "sensor_msgs/NavSatStatus": "int8 status\nuint16 service",
};
const definitions = {
  "sensor_msgs/msg/LaserScan":
    "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n" +
    "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n" +
    "float32[] ranges\nfloat32[] intensities",
  "sensor_msgs/msg/CompressedImage": "std_msgs/Header header\nstring format\nuint8[] data",
  "nav_msgs/msg/Odometry":
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n" +
    "geometry_msgs/TwistWithCovariance twist",
  "sensor_msgs/msg/Imu":
    "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n" +
    `float64[9] orientation_covariance\n${vector} angular_velocity\n` +
    `float64[9] angular_velocity_covariance\n${vector} linear_acceleration\n` +
    "float64[9] linear_acceleration_covariance",
  "sensor_msgs/msg/NavSatFix":
    "std_msgs/Header header\nsensor_msgs/NavSatStatus status\nfloat64 latitude\n" +
    "float64 longitude\nfloat64 altitude\nfloat64[9] position_covariance\n" +
    "uint8 position_covariance_type",
  "geometry_msgs/msg/PoseWithCovarianceStamped":
    "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose",
};
const rule = "\n" + "=".repeat(80) + "\n";
const whole = (type) =>
  definitions[type] + Object.entries(parts).map(([name, text]) => `${rule}MSG: ${name}\n${text}`).join("");

const [, , path, compression] = process.argv;
const command = { zstd: ["zstd", "-c", "-q"], lz4: ["lz4", "-c", "-q", "-z"] }[compression];
const file = await open(path, "w");
let written = 0n;
const writable = {
  write: async (bytes) => { written += BigInt((await file.write(bytes)).bytesWritten); },
  position: () => written,
};
const options = { writable, chunkSize: 200_000 };
if (command) {
  options.compressChunk = (chunk) => ({
    compression,
    compressedData: execFileSync(command[0], command.slice(1), { input: chunk, maxBuffer: 1 << 28 }),
  });
}
const writer = new McapWriter(options);
await writer.start({ profile: "ros2", library: "test" });
const channels = new Map();
let sequence = 0;
for (const line of readFileSync(0, "utf8").split("\n")) {
  const [time, topic, type, fields] = JSON.parse(line);
  if (!channels.has(topic)) {
    const text = whole(type);
    const schemaId = await writer.registerSchema({ name: type, encoding: "ros2msg", data: Buffer.from(text) });
    const id = await writer.registerChannel({ schemaId, topic, messageEncoding: "cdr", metadata: new Map() });
    channels.set(topic, { id, bytes: new MessageWriter(parse(text, { ros2: true })) });
  }
  if (fields.data) fields.data = Buffer.from(fields.data.base64, "base64");
  if (fields.ranges) fields.ranges = fields.ranges.map((r) => (r === "inf" ? Infinity : r));
  const { stamp } = fields.header;
  fields.header.stamp = { sec: stamp.sec, nanosec: stamp.nsec };
  const channel = channels.get(topic);
  await writer.addMessage({
    channelId: channel.id, sequence: sequence++, logTime: BigInt(time), publishTime: BigInt(time),
    data: channel.bytes.writeMessage(fields),
  });
}
await writer.end();
await file.close();

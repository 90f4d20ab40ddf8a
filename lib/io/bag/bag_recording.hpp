// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/bag/bag_rig.hpp"
#include "io/recording/recording_folder.hpp"
#include "ros/cloud_slice.hpp"

namespace orchard::io {

/// Parses `KIND=TOPIC` pairs. Throws FileError for an unknown kind or another form.
std::map<std::string, std::string> parse_topic_choices(const std::vector<std::string>& pairs);

/// Options for reading bags.
struct BagOptions {
  std::map<std::string, std::string> topics;  ///< topic by kind (scan, image ...); "none": no topic
  ros::CloudSlice slice;                      ///< slice of point clouds that are used as scans
};

/// Converts the bags of one drive to sensor messages, in order of their own times.
///
/// Each bag is read twice: once for topics and times, once in order of time. Memory therefore holds
/// only a few chunks and 40 bytes per message. A message without a time of its own gets the time of
/// recording, which ignored() counts.
class BagRecording {
 public:
  /// Receives the bytes (or rows) read so far and the total.
  using Progress = std::function<void(std::uint64_t, std::uint64_t)>;

  /// Throws FileError when a file is not a bag, or when the choice of a topic is ambiguous or
  /// wrong, naming the option to use.
  BagRecording(const std::vector<std::string>& paths, const BagOptions& options,
               const Progress& progress);
  ~BagRecording();
  BagRecording(const BagRecording&) = delete;
  BagRecording& operator=(const BagRecording&) = delete;

  /// Returns the next message with seq 0; none at the end.
  std::optional<SensorMessage> next();

  std::uint64_t num_messages() const;  ///< messages that next() examines
  /// Describes the chosen topic of each kind: "scan: /front/scan (sensor_msgs/LaserScan)".
  std::vector<std::string> choices() const;
  BagRig rig() const;  ///< what transforms and cameras tell about the chosen sensors
  std::map<std::string, std::int64_t> ignored() const;  ///< numbers by topic and reason
  std::vector<std::string> losses() const;              ///< each with the name of its file

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace orchard::io

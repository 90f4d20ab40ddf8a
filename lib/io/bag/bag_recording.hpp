// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/bag/bag_topics.hpp"
#include "io/recording/sensor_message.hpp"
#include "ros/cloud_slice.hpp"

namespace orchard::io {

/// How bags are read.
struct BagOptions {
  std::map<std::string, std::string> topics;  ///< by kind, as choose_topics takes them
  ros::CloudSlice slice;                      ///< of clouds that stand for a scan
};

/// The bags of one drive as sensor messages, in order of their own times.
///
/// Each bag is read twice: once to know its topics and times, once in order of time, so that memory
/// holds a few chunks and 40 bytes a message. A message without a time of its own gets the bag's,
/// which is said.
class BagRecording {
 public:
  /// Called with bytes (or rows) read so far, and all of them.
  using Progress = std::function<void(std::uint64_t, std::uint64_t)>;

  /// Throws FileError when a file is no bag, or choose_topics does.
  BagRecording(const std::vector<std::string>& paths, const BagOptions& options,
               const Progress& progress);
  ~BagRecording();
  BagRecording(const BagRecording&) = delete;
  BagRecording& operator=(const BagRecording&) = delete;

  /// The next message, seq left 0; none at the end.
  std::optional<SensorMessage> next();

  std::uint64_t num_messages() const;  ///< that next() looks at
  /// "scan: /front/scan (sensor_msgs/LaserScan)", one for each kind that is there.
  std::vector<std::string> choices() const;
  std::map<std::string, std::int64_t> ignored() const;  ///< by topic and reason
  std::vector<std::string> losses() const;              ///< each with its file

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace orchard::io

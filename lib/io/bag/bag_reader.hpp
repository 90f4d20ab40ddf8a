// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ros/ros_messages.hpp"

namespace orchard::io {

/// A topic of a bag.
struct BagTopic {
  std::string name;
  std::string type;                   ///< type name as in the bag
  ros::Wire wire = ros::Wire::kRos1;  ///< serialization of its messages
  bool is_known_wire = true;  ///< false: JSON, Protobuf or another one that is not supported
};

/// Position of a message in its bag, for reading it again.
struct BagPlace {
  std::uint64_t record = 0;  ///< offset of the chunk or message in the file; for SQLite the row id
  std::uint64_t within = 0;  ///< offset inside the chunk
};

/// One message of a bag; its bytes are valid until the next call of the reader.
struct BagMessage {
  std::size_t topic = 0;   ///< index into topics()
  std::int64_t utime = 0;  ///< time of recording [us]
  BagPlace place;
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
};

/// Reads a ROS 1 or ROS 2 bag from its beginning to its end.
///
/// Messages above 64 MB, chunks above 128 MB and what unpacks implausibly (unpacking_budget.hpp)
/// are not read. Damaged parts are skipped and listed in losses(); they are not errors.
class BagReader {
 public:
  static constexpr std::size_t kMaxMessageBytes = std::size_t{64} << 20;

  virtual ~BagReader() = default;

  /// Returns the next message, or none at the end.
  virtual std::optional<BagMessage> next() = 0;

  /// Reads the message at a place returned by next(); none if it is no longer there.
  virtual std::optional<BagMessage> at(const BagPlace& place) = 0;

  /// Topics found so far.
  virtual const std::vector<BagTopic>& topics() const = 0;

  /// Describes what could not be read; at most a hundred entries.
  virtual const std::vector<std::string>& losses() const = 0;

  virtual std::uint64_t position() const = 0;  ///< relative to size(), for progress
  virtual std::uint64_t size() const = 0;
};

/// Whether a file begins like a bag: rosbag's "#ROSBAG V2.0", or the magic of MCAP or SQLite.
bool is_bag(const std::string& path);

/// Opens a bag of any of the three formats. `on_progress` is called every few milliseconds of
/// reading and may throw. Throws FileError for another file.
std::unique_ptr<BagReader> open_bag(const std::string& path,
                                    const std::function<void()>& on_progress);

/// Lists the files of a bag that rosbag2 wrote as a folder, in order of their names; empty if the
/// folder has none. Throws FileError for files that are compressed as a whole.
std::vector<std::string> bag_files(const std::string& folder);

}  // namespace orchard::io

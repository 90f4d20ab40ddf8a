// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ros/ros_reader.hpp"

namespace orchard::io {

/// A topic of a bag.
struct BagTopic {
  std::string name;
  std::string type;                   ///< as the bag writes it
  ros::Wire wire = ros::Wire::kRos1;  ///< how its messages lie in their bytes
  bool is_known_wire = true;          ///< false: JSON, Protobuf, ... that is not read
};

/// Where a message stands in its bag, so that it can be read again.
struct BagPlace {
  std::uint64_t record = 0;  ///< of the chunk, or of the message, in the file; or a row's number
  std::uint64_t within = 0;  ///< in the chunk
};

/// One message of a bag; its bytes stay until the reader is asked again.
struct BagMessage {
  std::size_t topic = 0;   ///< index into topics()
  std::int64_t utime = 0;  ///< when the bag took it [us]
  BagPlace place;
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
};

/// A bag of ROS 1 or ROS 2, read from its beginning to its end.
///
/// Bounded: no message above 64 MB, no chunk above 256 MB is read. What is damaged is passed over
/// and said in losses(), never an error.
class BagReader {
 public:
  static constexpr std::size_t kMaxMessageBytes = std::size_t{64} << 20;

  virtual ~BagReader() = default;

  /// The next message, or none at the end.
  virtual std::optional<BagMessage> next() = 0;

  /// The message at a place that next() told; none when it is not there any more.
  virtual std::optional<BagMessage> at(const BagPlace& place) = 0;

  /// Those met so far.
  virtual const std::vector<BagTopic>& topics() const = 0;

  /// What could not be read, in words; at most a hundred.
  virtual const std::vector<std::string>& losses() const = 0;

  virtual std::uint64_t position() const = 0;  ///< of size(), for progress
  virtual std::uint64_t size() const = 0;
};

/// Whether a file begins as bags do: rosbag's "#ROSBAG V2.0", MCAP's or SQLite's magic.
bool is_bag(const std::string& path);

/// Opens a bag of any of the three formats. Throws FileError when it is none.
std::unique_ptr<BagReader> open_bag(const std::string& path);

/// The files of a bag that rosbag2 wrote as a folder, in order of their names; empty when the
/// folder holds none. Throws FileError for files that are compressed as a whole.
std::vector<std::string> bag_files(const std::string& folder);

}  // namespace orchard::io

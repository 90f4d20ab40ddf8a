// SPDX-License-Identifier: BSD-3-Clause
//
// Any bytes as a bag: the first byte chooses rosbag's format or MCAP's, and every message is read
// as each type that is known. A message that was read is there again, the same.
#include <cstdlib>
#include <cstring>
#include <memory>
#include <sstream>

#include "fuzz/fuzz_seeds.hpp"
#include "io/bag/record_bag.hpp"
#include "ros/cloud_slice.hpp"
#include "ros/ros_messages.hpp"

using namespace orchard;

namespace {

void read_as_every_type(const void* data, std::size_t size, ros::Wire wire) {
  ros::decode_header(data, size, wire);
  ros::decode_laser_scan(data, size, wire);
  ros::decode_imu(data, size, wire);
  ros::decode_nav_sat_fix(data, size, wire);
  ros::decode_odometry(data, size, wire);
  ros::decode_pose(data, size, wire, true);
  ros::decode_image(data, size, wire);
  ros::decode_compressed_image(data, size, wire);
  const auto cloud = ros::decode_point_cloud(data, size, wire);
  if (const auto* points = std::get_if<ros::PointCloud>(&cloud)) ros::slice_cloud(*points, {});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string content(reinterpret_cast<const char*>(data) + 1, size - 1);
  io::RecordBag bag(std::make_unique<std::istringstream>(content),
                    data[0] % 2 == 0 ? io::make_rosbag_format() : io::make_mcap_format(), [] {});
  int num_messages = 0;
  while (const auto message = bag.next()) {
    if (message->topic >= bag.topics().size()) std::abort();
    const ros::Wire wire = bag.topics()[message->topic].wire;
    read_as_every_type(message->data, message->size, wire);
    if (++num_messages > 1000) break;
    const std::string before(reinterpret_cast<const char*>(message->data), message->size);
    const auto place = message->place;
    const auto again = bag.at(place);
    if (!again || again->size != before.size() ||
        std::memcmp(again->data, before.data(), before.size()) != 0) {
      std::abort();
    }
  }
  return 0;
}

namespace orchard::fuzz {
namespace {

template <class T>
std::string number(T value) {
  return std::string(reinterpret_cast<const char*>(&value), sizeof(T));
}
std::string counted(const std::string& text) {
  return number(static_cast<std::uint32_t>(text.size())) + text;
}
std::string mcap_record(char opcode, const std::string& content) {
  return opcode + number(static_cast<std::uint64_t>(content.size())) + content;
}
std::string rosbag_record(const std::string& header, const std::string& data) {
  return counted(header) + counted(data);
}

/// A header, then a few numbers: enough for a scan of three beams.
std::string scan(bool is_cdr) {
  std::string bytes = is_cdr ? std::string("\0\1\0\0", 4) : number(std::uint32_t{1});
  bytes += number(std::uint32_t{10}) + number(std::uint32_t{20});
  bytes += is_cdr ? counted(std::string("las\0", 4)) : counted("las");
  for (int i = 0; i < 7; ++i) bytes += number(0.5f + 0.1f * static_cast<float>(i));
  return bytes + number(std::uint32_t{3}) + std::string(12, '\x3f') + number(std::uint32_t{0});
}

/// An ordered cloud of one line.
std::string cloud() {
  std::string bytes = number(std::uint32_t{1}) + number(std::uint32_t{10}) +
                      number(std::uint32_t{20}) + counted("l") + number(std::uint32_t{1}) +
                      number(std::uint32_t{24}) + number(std::uint32_t{3});
  for (std::uint32_t i = 0; i < 3; ++i) {
    bytes += counted(std::string(1, static_cast<char>('x' + i))) + number(4 * i) + '\7' +
             number(std::uint32_t{1});
  }
  bytes += std::string(1, '\0') + number(std::uint32_t{12}) + number(std::uint32_t{288});
  std::string points;
  for (int i = 0; i < 24; ++i) {
    points += number(2.0f) + number(0.05f * static_cast<float>(i)) + number(0.0f);
  }
  return bytes + counted(points) + '\1';
}

}  // namespace

std::vector<std::string> seeds() {
  const std::string topic =
      mcap_record(3, number(std::uint16_t{1}) + counted("sensor_msgs/msg/LaserScan") +
                         counted("ros2msg") + counted("float32 x")) +
      mcap_record(4, number(std::uint16_t{1}) + number(std::uint16_t{1}) + counted("/scan") +
                         counted("cdr") + number(std::uint32_t{0}));
  const std::string message =
      mcap_record(5, number(std::uint16_t{1}) + number(std::uint32_t{1}) +
                         number(std::uint64_t{5000}) + number(std::uint64_t{5000}) + scan(true));
  const std::string content = topic + message + message;
  const std::string chunk = mcap_record(
      6, number(std::uint64_t{1}) + number(std::uint64_t{2}) +
             number(static_cast<std::uint64_t>(content.size())) + number(std::uint32_t{0}) +
             counted("") + number(static_cast<std::uint64_t>(content.size())) + content);
  const std::string mcap = std::string("\1") + "\x89MCAP0\r\n" + chunk + message + chunk +
                           mcap_record(15, number(std::uint32_t{0}));
  const std::string connection = rosbag_record(
      counted("op=\7") + counted("conn=" + number(std::uint32_t{0})) + counted("topic=/scan"),
      counted("topic=/scan") + counted("type=sensor_msgs/LaserScan"));
  const auto said = [](const std::string& data) {
    return rosbag_record(counted("op=\2") + counted("conn=" + number(std::uint32_t{0})) +
                             counted("time=" + number(std::uint64_t{7})),
                         data);
  };
  const std::string inside = connection + said(scan(false)) + said(cloud());
  const std::string rosbag =
      std::string("\2") + "#ROSBAG V2.0\n" +
      rosbag_record(counted("op=\5") + counted("compression=none") +
                        counted("size=" + number(static_cast<std::uint32_t>(inside.size()))),
                    inside) +
      connection + said(cloud());
  return {"", mcap, rosbag, mcap.substr(0, mcap.size() / 2), rosbag.substr(0, rosbag.size() / 2)};
}

}  // namespace orchard::fuzz

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "bus/driver/driver.hpp"
#include "bus/messages/codec.hpp"
#include "bus/messages/message.hpp"
#include "device/camera/camera_frame.hpp"
#include "device/drivers_config.hpp"

namespace orchard::bus {

// libbot's messages as on the wire, in their original units (lcmtypes/bot_core).

struct BotPlanarLidar {
  std::int64_t utime = 0;
  std::vector<float> ranges;
  std::vector<float> intensities;
  float rad0 = 0.0f;
  float radstep = 0.0f;
};

struct BotImageMetadata {
  std::string key;
  std::vector<std::uint8_t> value;
};

struct BotImage {
  std::int64_t utime = 0;
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::int32_t row_stride = 0;
  std::int32_t pixelformat = 0;
  std::vector<std::uint8_t> data;
  std::vector<BotImageMetadata> metadata;
};

struct BotPose {
  std::int64_t utime = 0;
  std::array<double, 3> pos{};
  std::array<double, 3> vel{};
  std::array<double, 4> orientation{};
  std::array<double, 3> rotation_rate{};
  std::array<double, 3> accel{};
};

struct BotGpsData {
  std::int64_t utime = 0;
  std::int32_t gps_lock = 0;
  double longitude = 0.0;
  double latitude = 0.0;
  double elev = 0.0;
  double horizontal_accuracy = 0.0;
  double vertical_accuracy = 0.0;
  std::int32_t num_satellites = 0;
  double speed = 0.0;
  double heading = 0.0;
  std::array<double, 3> xyz_pos{};
  double gps_time = 0.0;
};

using BotCoreMessage = std::variant<BotPlanarLidar, BotImage, BotPose, BotGpsData>;

/// The bytes are not one of these types.
struct NotBotCore {};

/// Decodes and validates a libbot message: checks the size, every array count against the remaining
/// bytes before allocating, and the limits of each field. Invalid bytes never throw.
std::variant<NotBotCore, BotCoreMessage, Rejection> decode_bot_core(const void* data,
                                                                    std::size_t size);

/// Type name of the message held: "planar_lidar_t".
const char* bot_core_type_name(const BotCoreMessage& message);

/// Translates libbot's messages, live or from a log: planar_lidar_t to SCAN, image_t to IMAGE,
/// pose_t to ODOMETRY or POSE_FIX, gps_data_t to GNSS. utime is preserved.
class BotCoreTranslator {
 public:
  /// `max_image_bytes`: larger JPEGs and uncompressed images are compressed to this size.
  BotCoreTranslator(const device::BotCoreConfig& config, std::size_t max_image_bytes);

  /// Translates a message received on any channel; none when it has no translation.
  std::optional<Message> translate(const std::string& channel, const void* data, std::size_t size);

  /// Number of invalid messages of libbot's types.
  std::int64_t num_bad() const { return num_bad_; }

  /// Numbers of ignored messages by channel and reason; at most a hundred entries.
  const std::map<std::string, std::int64_t>& ignored() const { return ignored_; }

 private:
  /// Why a message has no translation, for the user.
  struct Nothing {
    std::string why;
    bool is_bad = true;
  };
  using Result = std::variant<Message, Nothing>;

  bool is_chosen(const std::string& channel, const BotCoreMessage& message);
  Result to_message(const BotPlanarLidar& lidar) const;
  Result to_message(BotImage& image);
  Result to_message(const BotPose& pose);
  Result to_message(const BotGpsData& gps) const;
  Result to_odometry(const BotPose& pose, double yaw_rad);
  std::optional<Message> finished(Message message, const std::string& channel);
  void ignore(const std::string& channel, const std::string& why);

  /// A pose from which a velocity is computed if none is sent.
  struct Place {
    std::int64_t utime;
    double x_m, y_m, yaw_rad;
  };

  device::BotCoreConfig config_;
  device::PictureLimit limit_;
  std::array<std::string, std::variant_size_v<BotCoreMessage>> channels_;  ///< one per type
  std::map<Channel, std::int32_t> next_seq_;
  std::map<Channel, std::int64_t> last_utime_;
  std::optional<Place> last_place_;
  std::int64_t num_bad_ = 0;
  std::map<std::string, std::int64_t> ignored_;
};

/// Uses a robot that publishes libbot's LCM types as a sensor: listens to all channels of its
/// network and sends the translated messages.
class BotCoreDriver : public Driver {
 public:
  /// Throws BusError when the network cannot be used.
  BotCoreDriver(const device::BotCoreConfig& config, std::size_t max_image_bytes);
  ~BotCoreDriver() override;

  std::vector<pollfd> files() override;
  Clock::time_point deadline() override;
  void step(const Outbox& send) override;
  DriverCondition condition() const override;

 private:
  struct Inbox;
  std::unique_ptr<Inbox> inbox_;
  BotCoreTranslator translator_;
  std::string lcm_url_;
  Clock::time_point heard_;
  bool has_heard_ = false;
};

}  // namespace orchard::bus

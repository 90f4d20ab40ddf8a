// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>

#include "bus/bot_core/bot_core_messages.hpp"
#include "bus/messages/message.hpp"
#include "device/bot_core_config.hpp"
#include "device/camera/picture_limit.hpp"

namespace orchard::bus {

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

}  // namespace orchard::bus

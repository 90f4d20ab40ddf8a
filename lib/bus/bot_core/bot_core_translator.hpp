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

/// Turns libbot's messages into ours, live and from a log alike: planar_lidar_t to SCAN, image_t to
/// IMAGE, pose_t to ODOMETRY or POSE_FIX, gps_data_t to GNSS. utime is carried through.
class BotCoreTranslator {
 public:
  /// `max_image_bytes`: larger and uncompressed pictures are compressed to that.
  BotCoreTranslator(const device::BotCoreConfig& config, std::size_t max_image_bytes);

  /// What follows from a message that came on a channel of any name; none when nothing does.
  std::optional<Message> translate(const std::string& channel, const void* data, std::size_t size);

  /// Messages of libbot's types that were refused, each once.
  std::int64_t num_bad() const { return num_bad_; }

  /// What became nothing, by channel and reason; at most a hundred kinds.
  const std::map<std::string, std::int64_t>& ignored() const { return ignored_; }

 private:
  /// Why a message became nothing, for a person.
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

  /// A position that a velocity is taken from where none is sent.
  struct Place {
    std::int64_t utime;
    double x_m, y_m, yaw_rad;
  };

  device::BotCoreConfig config_;
  device::PictureLimit limit_;
  std::array<std::string, std::variant_size_v<BotCoreMessage>> channels_;  ///< that are read
  std::map<Channel, std::int32_t> next_seq_;
  std::map<Channel, std::int64_t> last_utime_;
  std::optional<Place> last_place_;
  std::int64_t num_bad_ = 0;
  std::map<std::string, std::int64_t> ignored_;
};

}  // namespace orchard::bus

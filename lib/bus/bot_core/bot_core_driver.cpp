// SPDX-License-Identifier: BSD-3-Clause
#include "bus/bot_core/bot_core_driver.hpp"

#include <lcm/lcm.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <utility>
#include <vector>

#include "bot_core/gps_data_t.hpp"
#include "bot_core/image_t.hpp"
#include "bot_core/planar_lidar_t.hpp"
#include "bot_core/pose_t.hpp"
#include "bus/bus.hpp"
#include "bus/messages/field_codec.hpp"
#include "bus/socket_guard.hpp"
#include "geometry/angles.hpp"

namespace orchard::bus {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{32} << 20;  // an image of many megapixels
constexpr std::int32_t kAnyInt = std::numeric_limits<std::int32_t>::max();

// The fields in wire order; see bus/messages/fields.hpp. Limits are given where a bad value would
// reach a computation.

struct PlanarLidarFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.time("utime", m.utime);
    v.count("nranges", m.ranges);
    v.array("ranges", m.ranges, "nranges");
    v.count("nintensities", m.intensities);
    v.array("intensities", m.intensities, "nintensities");
    v.field("rad0", m.rad0, -100, 100);
    v.field("radstep", m.radstep, -10, 10);
  }
};

struct ImageMetadataFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.text("key", m.key);
    v.count("n", m.value);
    v.array("value", m.value, "n");
  }
};

struct BotImageFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.time("utime", m.utime);
    v.field("width", m.width, 1, 16384);
    v.field("height", m.height, 1, 16384);
    v.field("row_stride", m.row_stride, 0, 1 << 20);
    v.field("pixelformat", m.pixelformat, -kAnyInt - 1, kAnyInt);
    v.count("size", m.data);
    v.array("data", m.data, "size");
    v.count("nmetadata", m.metadata);
    v.items("metadata", m.metadata, "nmetadata", ImageMetadataFields{});
  }
};

struct BotPoseFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.time("utime", m.utime);
    v.field("pos", m.pos, -1e8, 1e8);
    v.field("vel", m.vel, -1e3, 1e3);
    v.field("orientation", m.orientation, -2, 2);
    v.field("rotation_rate", m.rotation_rate, -1e3, 1e3);
    v.field("accel", m.accel, -1e300, 1e300);
  }
};

struct BotGpsDataFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.time("utime", m.utime);
    v.field("gps_lock", m.gps_lock, -kAnyInt - 1, kAnyInt);
    v.field("longitude", m.longitude, -180, 180);
    v.field("latitude", m.latitude, -90, 90);
    v.field("elev", m.elev, -12000, 100000);
    v.field("horizontal_accuracy", m.horizontal_accuracy, -1e6, 1e6);
    v.field("vertical_accuracy", m.vertical_accuracy, -1e6, 1e6);
    v.field("numSatellites", m.num_satellites, -kAnyInt - 1, kAnyInt);
    v.field("speed", m.speed, -1e300, 1e300);
    v.field("heading", m.heading, -1e300, 1e300);
    v.field("xyz_pos", m.xyz_pos, -1e300, 1e300);
    v.field("gps_time", m.gps_time, -1e300, 1e300);
  }
};

template <class M, class Fields>
std::variant<NotBotCore, BotCoreMessage, Rejection> decode_as(const std::uint8_t* data,
                                                              std::size_t size) {
  if (size > kMaxBytes) return Rejection{Reason::kTooLarge, std::to_string(size) + " bytes"};
  M message;
  FieldReader reader(data, size, sizeof(std::int64_t));
  Fields::visit(message, reader);
  if (auto rejection = std::move(reader).result()) return *std::move(rejection);
  FieldCheck check;
  Fields::visit(std::as_const(message), check);
  if (auto rejection = std::move(check).result()) return *std::move(rejection);
  return BotCoreMessage(std::move(message));
}

constexpr std::size_t kMaxKinds = 100;
constexpr std::int64_t kLongestStep_us = 1'000'000;

using device::CameraFrame;
using device::PixelFormat;

/// FourCC code of a name read from left to right.
constexpr std::int32_t fourcc(const char (&name)[5]) {
  return static_cast<std::int32_t>(static_cast<unsigned char>(name[0])) |
         static_cast<std::int32_t>(static_cast<unsigned char>(name[1])) << 8 |
         static_cast<std::int32_t>(static_cast<unsigned char>(name[2])) << 16 |
         static_cast<std::int32_t>(static_cast<unsigned char>(name[3])) << 24;
}

/// Pixel format for libbot's number; converts UYVY to YUYV. None if unsupported.
std::optional<PixelFormat> format_of(std::int32_t pixelformat, std::vector<std::uint8_t>& data) {
  switch (pixelformat) {
    case fourcc("MJPG"):
      return PixelFormat::kJpeg;
    case fourcc("BGR3"):
      return PixelFormat::kBgr;
    case fourcc("RGB3"):
      return PixelFormat::kRgb;
    case fourcc("GREY"):
      return PixelFormat::kGrey;
    case fourcc("UYVY"):
      for (std::size_t i = 0; i + 1 < data.size(); i += 2) std::swap(data[i], data[i + 1]);
      return PixelFormat::kYuyv;
    case fourcc("YUYV"):
      return PixelFormat::kYuyv;
    default:
      return std::nullopt;
  }
}

/// Rotates a vector from the local frame into the body frame, by the inverse of the unit quaternion
/// w, x, y, z.
std::array<double, 3> into_body(const std::array<double, 4>& q, const std::array<double, 3>& v) {
  const double w = q[0], x = -q[1], y = -q[2], z = -q[3];
  const std::array<double, 3> t{2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]),
                                2 * (x * v[1] - y * v[0])};
  return {v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2],
          v[2] + w * t[2] + x * t[1] - y * t[0]};
}

bool is_zero(const std::array<double, 3>& v) { return v[0] == 0.0 && v[1] == 0.0 && v[2] == 0.0; }

constexpr int kQueue = 500;      // LCM drops messages beyond it
constexpr int kMaxAtOnce = 200;  // then STATUS and a stop are checked
constexpr auto kSilence = std::chrono::seconds(1);

}  // namespace

std::variant<NotBotCore, BotCoreMessage, Rejection> decode_bot_core(const void* data,
                                                                    std::size_t size) {
  if (data == nullptr || size < sizeof(std::int64_t)) return NotBotCore{};
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  std::uint64_t bits = 0;
  for (int i = 0; i < 8; ++i) bits = bits << 8 | bytes[i];
  const auto hash = static_cast<std::int64_t>(bits);
  if (hash == bot_core::planar_lidar_t::getHash()) {
    return decode_as<BotPlanarLidar, PlanarLidarFields>(bytes, size);
  }
  if (hash == bot_core::image_t::getHash()) return decode_as<BotImage, BotImageFields>(bytes, size);
  if (hash == bot_core::pose_t::getHash()) return decode_as<BotPose, BotPoseFields>(bytes, size);
  if (hash == bot_core::gps_data_t::getHash()) {
    return decode_as<BotGpsData, BotGpsDataFields>(bytes, size);
  }
  return NotBotCore{};
}

const char* bot_core_type_name(const BotCoreMessage& message) {
  constexpr std::array<const char*, 4> kNames{"planar_lidar_t", "image_t", "pose_t", "gps_data_t"};
  return kNames.at(message.index());
}

BotCoreTranslator::BotCoreTranslator(const device::BotCoreConfig& config,
                                     std::size_t max_image_bytes)
    : config_(config),
      limit_(max_image_bytes),
      channels_{config.scan_channel, config.image_channel, config.pose_channel,
                config.gps_channel} {}

std::optional<Message> BotCoreTranslator::translate(const std::string& channel, const void* data,
                                                    std::size_t size) {
  auto decoded = decode_bot_core(data, size);
  if (std::holds_alternative<NotBotCore>(decoded)) {
    ignore(channel, "not one of the supported types of libbot");
    return std::nullopt;
  }
  if (const auto* rejection = std::get_if<Rejection>(&decoded)) {
    ++num_bad_;
    ignore(channel, std::string(to_string(rejection->reason)));
    return std::nullopt;
  }
  auto& message = std::get<BotCoreMessage>(decoded);
  if (!is_chosen(channel, message)) {
    ignore(channel, std::string("a second channel of ") + bot_core_type_name(message) +
                        "; choose one in section drivers.bot_core");
    return std::nullopt;
  }
  Result result = std::visit([this](auto& m) { return to_message(m); }, message);
  if (const auto* nothing = std::get_if<Nothing>(&result)) {
    num_bad_ += nothing->is_bad ? 1 : 0;
    ignore(channel, nothing->why);
    return std::nullopt;
  }
  return finished(std::get<Message>(std::move(result)), channel);
}

bool BotCoreTranslator::is_chosen(const std::string& channel, const BotCoreMessage& message) {
  std::string& chosen = channels_[message.index()];
  if (chosen.empty()) chosen = channel;
  return chosen == channel;
}

BotCoreTranslator::Result BotCoreTranslator::to_message(const BotPlanarLidar& lidar) const {
  laser::Scan scan;
  scan.utime = lidar.utime;
  scan.bearing_min_rad = lidar.rad0;
  scan.bearing_step_rad = lidar.radstep;
  scan.range_min_m = config_.range_min_m;
  scan.range_max_m = config_.range_max_m;
  scan.ranges_m = lidar.ranges;
  scan.intensities = lidar.intensities;
  return Message(std::move(scan));
}

BotCoreTranslator::Result BotCoreTranslator::to_message(BotImage& image) {
  const std::optional<PixelFormat> format = format_of(image.pixelformat, image.data);
  if (!format) return Nothing{"pixelformat " + std::to_string(image.pixelformat)};
  CameraFrame frame;
  frame.utime = image.utime;
  frame.width_px = image.width;
  frame.height_px = image.height;
  frame.format = *format;
  frame.row_bytes = image.row_stride;
  frame.data = std::move(image.data);
  auto fitted = limit_.fit(std::move(frame));
  if (auto* none = std::get_if<device::NoPicture>(&fitted)) return Nothing{std::move(none->why)};
  return Message(std::get<vision::Image>(std::move(fitted)));
}

BotCoreTranslator::Result BotCoreTranslator::to_message(const BotPose& pose) {
  const auto& q = pose.orientation;
  const double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (std::abs(norm - 1.0) > 0.01) return Nothing{"its orientation is not a unit quaternion"};
  const double yaw_rad =
      std::atan2(2 * (q[0] * q[3] + q[1] * q[2]), 1 - 2 * (q[2] * q[2] + q[3] * q[3]));
  if (config_.pose_as == device::BotPoseAs::kOdometry) return to_odometry(pose, yaw_rad);
  pose::PoseFix fix;
  fix.utime = pose.utime;
  fix.x_m = pose.pos[0];
  fix.y_m = pose.pos[1];
  fix.yaw_rad = yaw_rad;
  return Message(fix);
}

BotCoreTranslator::Result BotCoreTranslator::to_odometry(const BotPose& pose, double yaw_rad) {
  const std::optional<Place> before =
      std::exchange(last_place_, Place{pose.utime, pose.pos[0], pose.pos[1], yaw_rad});
  pose::Odometry odometry;
  odometry.utime = pose.utime;
  if (!is_zero(pose.vel) || !is_zero(pose.rotation_rate)) {
    odometry.speed_mps = into_body(pose.orientation, pose.vel)[0];
    odometry.yaw_rate_radps = into_body(pose.orientation, pose.rotation_rate)[2];
    return Message(odometry);
  }
  // No velocity is sent (or the robot stands still): use the mean velocity since the last pose.
  const std::int64_t step_us = before ? pose.utime - before->utime : 0;
  if (step_us <= 0 || step_us > kLongestStep_us) {
    return Nothing{"no velocity, and no earlier pose to compute it from", false};
  }
  const double step_s = 1e-6 * static_cast<double>(step_us);
  const double turn_rad = geometry::wrap_angle_rad(yaw_rad - before->yaw_rad);
  const double heading_rad = before->yaw_rad + turn_rad / 2;
  odometry.speed_mps = ((pose.pos[0] - before->x_m) * std::cos(heading_rad) +
                        (pose.pos[1] - before->y_m) * std::sin(heading_rad)) /
                       step_s;
  odometry.yaw_rate_radps = turn_rad / step_s;
  return Message(odometry);
}

BotCoreTranslator::Result BotCoreTranslator::to_message(const BotGpsData& gps) const {
  // Values of gps_lock: 1 dead reckoning, 2 and 3 satellites, 4 both.
  const bool is_estimated = gps.gps_lock == 1;
  if (!is_estimated && (gps.gps_lock < 2 || gps.gps_lock > 4)) {
    return Nothing{"no fix (gps_lock " + std::to_string(gps.gps_lock) + ")", false};
  }
  pose::Gnss gnss;
  gnss.utime = gps.utime;
  gnss.latitude_deg = gps.latitude;
  gnss.longitude_deg = gps.longitude;
  gnss.altitude_m = gps.elev;
  gnss.fix_quality = is_estimated ? 6 : 1;
  if (gps.horizontal_accuracy > 0.0) {
    gnss.covariance[0] = gnss.covariance[3] = gps.horizontal_accuracy * gps.horizontal_accuracy;
    const double up_sd_m = gps.vertical_accuracy > 0.0 ? gps.vertical_accuracy : 100.0;
    gnss.covariance[5] = up_sd_m * up_sd_m;
  }
  return Message(gnss);
}

std::optional<Message> BotCoreTranslator::finished(Message message, const std::string& channel) {
  const Channel ours = channel_of(message);
  const std::vector<std::uint8_t> bytes = encode(message);
  const auto checked = decode(ours, bytes.data(), bytes.size());
  if (const auto* rejection = std::get_if<Rejection>(&checked)) {
    ++num_bad_;
    ignore(channel, std::string(to_string(rejection->reason)));
    return std::nullopt;
  }
  const auto last = last_utime_.find(ours);
  if (last != last_utime_.end() && utime_of(message) == last->second) {
    ignore(channel, "same utime as the message before");
    return std::nullopt;
  }
  last_utime_[ours] = utime_of(message);
  std::visit([seq = next_seq_[ours]++](auto& m) { m.seq = seq; }, message);
  return message;
}

void BotCoreTranslator::ignore(const std::string& channel, const std::string& why) {
  const std::string kind = channel.substr(0, 64) + ": " + why;
  const auto found = ignored_.find(kind);
  if (found != ignored_.end()) {
    ++found->second;
  } else if (ignored_.size() < kMaxKinds) {
    ignored_[kind] = 1;
  }
}

struct BotCoreDriver::Inbox {
  SocketGuard guard;  // constructed before LCM opens its sockets
  lcm_t* lcm = nullptr;
  BotCoreTranslator* translator = nullptr;
  std::vector<Message> messages;
  std::exception_ptr pending;

  ~Inbox() {
    if (lcm != nullptr) lcm_destroy(lcm);
  }

  /// LCM's C frames are on the stack: no exception may leave this function.
  static void on_message(const lcm_recv_buf_t* buffer, const char* channel, void* context) {
    auto* inbox = static_cast<Inbox*>(context);
    try {
      auto message = inbox->translator->translate(channel, buffer->data, buffer->data_size);
      if (message) inbox->messages.push_back(*std::move(message));
    } catch (...) {
      inbox->pending = std::current_exception();
    }
  }
};

BotCoreDriver::BotCoreDriver(const device::BotCoreConfig& config, std::size_t max_image_bytes)
    : inbox_(std::make_unique<Inbox>()),
      translator_(config, max_image_bytes),
      lcm_url_(config.lcm_url),
      heard_(Clock::now()) {
  inbox_->translator = &translator_;
  inbox_->lcm = lcm_create(lcm_url_.c_str());
  if (inbox_->lcm == nullptr) {
    throw BusError(
        "LCM cannot use drivers.bot_core.lcm_url " + lcm_url_ +
        ": check its address and port, and the multicast route (`orchard doctor` tests it)");
  }
  lcm_subscription_t* subscription =
      lcm_subscribe(inbox_->lcm, ".*", &Inbox::on_message, inbox_.get());
  if (subscription == nullptr) throw BusError("cannot subscribe to messages on " + lcm_url_);
  lcm_subscription_set_queue_capacity(subscription, kQueue);
  const bool is_network = lcm_url_.compare(0, 7, "udpm://") == 0;
  if (is_network && inbox_->guard.attach() == 0) {
    spdlog::warn(
        "the socket of {} has no filter: malformed datagrams can crash this process (see "
        "SECURITY.md)",
        lcm_url_);
  }
}

BotCoreDriver::~BotCoreDriver() = default;

std::vector<pollfd> BotCoreDriver::files() { return {{lcm_get_fileno(inbox_->lcm), POLLIN, 0}}; }

Driver::Clock::time_point BotCoreDriver::deadline() { return Clock::time_point::max(); }

void BotCoreDriver::step(const Outbox& send) {
  for (int i = 0; i < kMaxAtOnce; ++i) {
    if (lcm_handle_timeout(inbox_->lcm, 0) <= 0) break;
    if (inbox_->pending) std::rethrow_exception(std::exchange(inbox_->pending, nullptr));
  }
  for (Message& message : inbox_->messages) {
    heard_ = Clock::now();
    has_heard_ = true;
    send(std::move(message));
  }
  inbox_->messages.clear();
}

DriverCondition BotCoreDriver::condition() const {
  DriverCondition condition;
  condition.num_bad = translator_.num_bad();
  if (!has_heard_) {
    condition.level = Level::kWaiting;
    condition.text = "waits for planar_lidar_t, image_t, pose_t or gps_data_t on " + lcm_url_;
  } else if (Clock::now() - heard_ > kSilence) {
    condition.level = Level::kError;
    condition.text = "no message of libbot's types for more than a second on " + lcm_url_;
  }
  return condition;
}

}  // namespace orchard::bus

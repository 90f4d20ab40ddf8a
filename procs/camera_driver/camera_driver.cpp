// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/camera_driver.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <variant>

#include "bus/driver/source.hpp"
#include "bus/process/process.hpp"
#include "io/camera/picture_camera.hpp"
#include "io/camera/v4l2_camera.hpp"

namespace orchard::procs {
namespace {

constexpr auto kSilence = std::chrono::seconds(1);
constexpr auto kHang = std::chrono::seconds(4);
constexpr int kDatagram_bytes = 60000;
constexpr std::size_t kMaxFramesAtOnce = 8;

/// A camera source that plays the pictures of a log.
class LogCamera : public io::CameraSource {
 public:
  LogCamera(const std::string& path, std::int64_t start_utime)
      : log_(path, start_utime, {bus::Channel::kImage}) {}

  int fileno() const override { return -1; }
  Clock::time_point deadline() const override { return log_.deadline(); }
  std::optional<device::CameraFrame> take() override {
    auto message = log_.take_due();
    auto* image = message ? std::get_if<vision::Image>(&*message) : nullptr;
    if (image == nullptr) return std::nullopt;
    device::CameraFrame frame;
    frame.utime = image->utime;
    frame.width_px = image->width_px;
    frame.height_px = image->height_px;
    const bool is_bgr = image->encoding == vision::Encoding::kBgr8;
    if (is_bgr || image->encoding == vision::Encoding::kGray8) {
      frame.format = is_bgr ? device::PixelFormat::kBgr : device::PixelFormat::kGrey;
      frame.row_bytes = image->width_px * (is_bgr ? 3 : 1);
    }
    frame.data = std::move(image->data);
    return frame;
  }
  std::string problem() const override { return {}; }
  void restart(const std::string&) override {}
  bool ended() const override { return log_.deadline() == Clock::time_point::max(); }

 private:
  bus::PlayedLog log_;
};

std::unique_ptr<io::CameraSource> open_source(const CameraDriverOptions& options,
                                              const io::Config& config) {
  const std::int64_t start_utime = bus::parse_utime("--emulate-at", options.emulate_at);
  if (!options.emulate.empty()) return std::make_unique<LogCamera>(options.emulate, start_utime);
  const std::string& device =
      options.device.empty() ? config.drivers.camera.device : options.device;
  const std::string pictures = "pictures:";
  if (device.compare(0, pictures.size(), pictures) == 0) {
    return io::open_picture_folder(device.substr(pictures.size()), start_utime);
  }
  if (device.empty() || device.front() != '/') {
    throw std::invalid_argument("drivers.camera.device \"" + device +
                                "\": must be a device like /dev/video0, or pictures:FOLDER");
  }
  const io::CameraMode mode{config.camera.intrinsics.width_px, config.camera.intrinsics.height_px,
                            config.drivers.camera.rate_hz};
  return std::make_unique<io::V4l2Camera>(device, mode);
}

}  // namespace

CameraDriver::CameraDriver(std::unique_ptr<io::CameraSource> source,
                           const device::CameraDriverConfig& config, int width_px, int height_px)
    : source_(std::move(source)),
      config_(config),
      width_px_(width_px),
      height_px_(height_px),
      limit_(static_cast<std::size_t>(config.max_bytes)) {}

std::vector<pollfd> CameraDriver::files() {
  if (source_->fileno() < 0) return {};
  return {{source_->fileno(), POLLIN, 0}};
}

bus::Driver::Clock::time_point CameraDriver::deadline() {
  // Wake up to detect a silent camera even when nothing happens.
  const auto observation = source_->fileno() < 0 ? Clock::time_point::max() : heard_ + kHang;
  return std::min(source_->deadline(), std::max(observation, Clock::now()));
}

void CameraDriver::step(const bus::Outbox& send) {
  for (std::size_t i = 0; i < kMaxFramesAtOnce; ++i) {
    std::optional<device::CameraFrame> frame = source_->take();
    if (!frame) break;
    heard_ = Clock::now();
    take(*std::move(frame), send);
  }
  restart_when_silent();
}

void CameraDriver::restart_when_silent() {
  if (source_->fileno() < 0) {
    heard_ = std::max(heard_,
                      Clock::now() - kSilence);  // it needs time to open
  } else if (Clock::now() - heard_ > kHang) {
    source_->restart("no picture for 4 s; reopening the camera");
    heard_ = Clock::now();
  } else if (watch_.is_frozen()) {
    source_->restart("repeats the same picture; reopening the camera");
    watch_.restart();
  }
}

void CameraDriver::take(device::CameraFrame frame, const bus::Outbox& send) {
  watch_.add(frame.data);
  // A camera may support only higher rates: skip frames.
  const double period_us = 1e6 / config_.rate_hz;
  if (last_utime_ && static_cast<double>(frame.utime - *last_utime_) < 0.9 * period_us &&
      frame.utime > *last_utime_) {
    return;
  }
  if (frame.width_px != width_px_ || frame.height_px != height_px_) {
    ++num_refused_;
    refusal_ = "pictures are " + std::to_string(frame.width_px) + "x" +
               std::to_string(frame.height_px) + ", but camera.width_px and height_px are " +
               std::to_string(width_px_) + "x" + std::to_string(height_px_);
    return;
  }
  last_utime_ = frame.utime;
  auto fitted = limit_.fit(std::move(frame));
  if (const auto* none = std::get_if<device::NoPicture>(&fitted)) {
    ++num_refused_;
    refusal_ = none->why;
    return;
  }
  refusal_.clear();
  vision::Image& image = std::get<vision::Image>(fitted);
  image.seq = next_seq_++;
  send(std::move(image));
}

bus::DriverCondition CameraDriver::condition() const {
  bus::DriverCondition condition;
  condition.num_bad = num_refused_ + source_->num_damaged();
  const auto say = [&condition](bus::Level level, const std::string& text) {
    if (!condition.text.empty()) return;
    condition.level = level;
    condition.text = text;
  };
  if (const std::string problem = source_->problem(); !problem.empty()) {
    say(bus::Level::kError, problem);
  }
  if (source_->fileno() >= 0 && Clock::now() - heard_ > kSilence) {
    say(bus::Level::kError, "no picture for more than a second");
  }
  if (watch_.is_frozen()) say(bus::Level::kError, "the picture is frozen: ten identical pictures");
  if (!refusal_.empty()) say(bus::Level::kWarning, "refused: " + refusal_);
  if (config_.max_bytes > kDatagram_bytes) {
    say(bus::Level::kWarning,
        "drivers.camera.max_bytes is above 60000: such pictures need several datagrams, and losing "
        "one loses the picture");
  }
  return condition;
}

std::unique_ptr<CameraDriver> make_camera_driver(const CameraDriverOptions& options,
                                                 const io::Config& config) {
  return std::make_unique<CameraDriver>(open_source(options, config), config.drivers.camera,
                                        config.camera.intrinsics.width_px,
                                        config.camera.intrinsics.height_px);
}

}  // namespace orchard::procs

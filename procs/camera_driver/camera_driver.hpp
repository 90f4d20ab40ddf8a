// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "bus/driver/driver.hpp"
#include "device/camera/camera_frame.hpp"
#include "device/drivers_config.hpp"
#include "io/camera/camera_source.hpp"
#include "io/config/config.hpp"

namespace orchard::procs {

/// Command-line options of orchard-camera-driver beyond the common ones, as typed.
struct CameraDriverOptions {
  std::string device;      ///< overrides the configuration's device
  std::string emulate;     ///< log whose pictures are played instead of a device
  std::string emulate_at;  ///< utime at which its first event is played [us]
};

/// Publishes a camera's pictures as IMAGE: at most at the configured rate, only in the calibrated
/// size, within the limit of bytes. Reopens a camera that is gone, silent or frozen, and reports
/// it.
class CameraDriver : public bus::Driver {
 public:
  /// `width_px`, `height_px`: image size of the calibration.
  CameraDriver(std::unique_ptr<io::CameraSource> source, const device::CameraDriverConfig& config,
               int width_px, int height_px);

  std::vector<pollfd> files() override;
  Clock::time_point deadline() override;
  void step(const bus::Outbox& send) override;
  bool ended() const override { return source_->ended(); }
  bus::DriverCondition condition() const override;

 private:
  void take(device::CameraFrame frame, const bus::Outbox& send);
  void restart_when_silent();

  std::unique_ptr<io::CameraSource> source_;
  device::CameraDriverConfig config_;
  int width_px_;
  int height_px_;
  device::PictureLimit limit_;
  device::FrameWatch watch_;
  Clock::time_point heard_ = Clock::now();
  std::optional<std::int64_t> last_utime_;
  std::int32_t next_seq_ = 0;
  std::int64_t num_refused_ = 0;
  std::string refusal_;  ///< reason why the last frame gave no picture; empty: it gave one
};

/// Makes the driver for the options and the rig. Throws io::FileError, std::invalid_argument.
std::unique_ptr<CameraDriver> make_camera_driver(const CameraDriverOptions& options,
                                                 const io::Config& config);

}  // namespace orchard::procs

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "device/camera/camera_frame.hpp"

namespace orchard::io {

/// Source of images: a camera, or files that emulate one. Never blocks.
class CameraSource {
 public:
  using Clock = std::chrono::steady_clock;
  virtual ~CameraSource() = default;

  /// File descriptor that becomes readable when an image is available; -1: none at present.
  virtual int fileno() const = 0;

  /// Time at which take() must be called even if the file is not readable.
  virtual Clock::time_point deadline() const = 0;

  /// Returns the next available image; reopens the device when an attempt is due.
  virtual std::optional<device::CameraFrame> take() = 0;

  /// Why no image can be delivered, for the user; empty if one can.
  virtual std::string problem() const = 0;

  /// Closes a device that hangs; it is reopened shortly afterwards.
  virtual void restart(const std::string& why) = 0;

  virtual bool ended() const = 0;

  /// Number of images that the device marked as damaged.
  virtual std::int64_t num_damaged() const { return 0; }
};

}  // namespace orchard::io

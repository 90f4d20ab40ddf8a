// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "device/camera/camera_frame.hpp"

namespace orchard::io {

/// Where pictures come from: a camera, or files that play one. Never blocks.
class CameraSource {
 public:
  using Clock = std::chrono::steady_clock;
  virtual ~CameraSource() = default;

  /// A file that becomes readable when a picture is there; -1: none at present.
  virtual int fileno() const = 0;

  /// When take() is wanted although the file is not readable.
  virtual Clock::time_point deadline() const = 0;

  /// The next picture that is there; opens the device again when it is time to.
  virtual std::optional<device::CameraFrame> take() = 0;

  /// Why no picture can come, in words for a person; empty: one can.
  virtual std::string problem() const = 0;

  /// Closes the device because it hangs; it is opened again in a moment.
  virtual void restart(const std::string& why) = 0;

  virtual bool ended() const = 0;

  /// Pictures that the device itself marked as damaged.
  virtual std::int64_t num_damaged() const { return 0; }
};

}  // namespace orchard::io

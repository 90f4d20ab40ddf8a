// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "io/camera/camera_source.hpp"

namespace orchard::io {

/// Returns one image after the other, with the utime of the files; none at the end.
using NextFrame = std::function<std::optional<device::CameraFrame>()>;

/// Emulates a camera with images: each is delivered at its time relative to the first, and stamped
/// with exactly that time on the host's clock.
class PictureCamera : public CameraSource {
 public:
  /// `first_utime`, in the time of the files, corresponds to `start_utime` on the host's clock.
  PictureCamera(NextFrame next, std::int64_t first_utime, std::int64_t start_utime);

  int fileno() const override { return -1; }
  Clock::time_point deadline() const override;
  std::optional<device::CameraFrame> take() override;
  std::string problem() const override { return problem_; }
  void restart(const std::string&) override {}
  bool ended() const override { return !frame_; }

 private:
  void find_next();

  NextFrame next_;
  std::int64_t shift_us_;
  std::optional<device::CameraFrame> frame_;
  std::string problem_;
};

/// Opens the files FOLDER/<utime_us>.jpg. `start_utime`: time of the first image [us]; 0: its own
/// time if that is within the next hour, else now. Throws FileError.
std::unique_ptr<CameraSource> open_picture_folder(const std::string& folder,
                                                  std::int64_t start_utime);

}  // namespace orchard::io

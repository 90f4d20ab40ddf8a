// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "io/camera/camera_source.hpp"

namespace orchard::io {

/// Pictures that files hold, one after the other, utime as the files have it; none at the end.
using NextFrame = std::function<std::optional<device::CameraFrame>()>;

/// Plays pictures as a camera would give them: each at its time, counted from the first, and
/// stamped with exactly that time by the host's clock.
class PictureCamera : public CameraSource {
 public:
  /// `first_utime`: what `start_utime` of the host's clock stands for, in the time of the files.
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

/// The files FOLDER/<utime_us>.jpg. `start_utime`: when the first is given [us]; 0: at its own time
/// where that is within an hour from now, else now. Throws FileError.
std::unique_ptr<CameraSource> open_picture_folder(const std::string& folder,
                                                  std::int64_t start_utime);

/// A video that OpenCV can read, at its own rate. Throws FileError.
std::unique_ptr<CameraSource> open_video(const std::string& path, std::int64_t start_utime);

}  // namespace orchard::io

// SPDX-License-Identifier: BSD-3-Clause
#include "io/camera/picture_camera.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include "io/file_error.hpp"
#include "io/recording/jpeg_file.hpp"

namespace orchard::io {
namespace {

constexpr std::int64_t kSoon_us = 3'600'000'000;

std::int64_t time_of_day_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

PictureCamera::PictureCamera(NextFrame next, std::int64_t first_utime, std::int64_t start_utime)
    : next_(std::move(next)), shift_us_(start_utime - first_utime) {
  find_next();
}

CameraSource::Clock::time_point PictureCamera::deadline() const {
  if (!frame_) return Clock::time_point::max();
  const std::int64_t wait_us = std::max<std::int64_t>(frame_->utime - time_of_day_us(), 0);
  return Clock::now() + std::chrono::microseconds(wait_us);
}

std::optional<device::CameraFrame> PictureCamera::take() {
  if (!frame_ || frame_->utime > time_of_day_us()) return std::nullopt;
  std::optional<device::CameraFrame> due = std::exchange(frame_, std::nullopt);
  find_next();
  return due;
}

void PictureCamera::find_next() {
  frame_ = next_();
  if (frame_) frame_->utime += shift_us_;
}

std::unique_ptr<CameraSource> open_picture_folder(const std::string& folder,
                                                  std::int64_t start_utime) {
  std::vector<TimedJpeg> files = list_jpegs(folder, OtherFiles::kSkip);
  if (files.empty())
    throw FileError(folder + ": has no picture <utime_us>.jpg; give the folder of the pictures");
  const std::int64_t first = files.front().utime, now = time_of_day_us();
  if (start_utime == 0) start_utime = first >= now && first - now < kSoon_us ? first : now;
  NextFrame next = [files = std::move(files),
                    i = std::size_t{0}]() mutable -> std::optional<device::CameraFrame> {
    if (i == files.size()) return std::nullopt;
    vision::Image image = read_jpeg_file(files[i].path);
    device::CameraFrame frame;
    frame.utime = files[i++].utime;
    frame.width_px = image.width_px;
    frame.height_px = image.height_px;
    frame.data = std::move(image.data);
    return frame;
  };
  return std::make_unique<PictureCamera>(std::move(next), first, start_utime);
}

}  // namespace orchard::io

// SPDX-License-Identifier: BSD-3-Clause
#include "io/camera/picture_camera.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
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

std::unique_ptr<CameraSource> open_video(const std::string& path, std::int64_t start_utime) {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // reported below
  // Files only: the other backends would ask every USB device whether it is a camera.
  auto video = std::make_shared<cv::VideoCapture>(path, cv::CAP_FFMPEG);
  if (!video->isOpened()) {
    throw FileError(path + ": cannot be read as a video; give a video file such as .avi or .mp4");
  }
  double rate_hz = video->get(cv::CAP_PROP_FPS);
  if (!(rate_hz > 0.0 && rate_hz <= 1000.0)) rate_hz = 25.0;  // the file has no rate
  NextFrame next = [video, rate_hz, i = 0]() mutable -> std::optional<device::CameraFrame> {
    cv::Mat picture;
    if (!video->read(picture) || picture.type() != CV_8UC3) return std::nullopt;
    device::CameraFrame frame;
    frame.utime = std::llround(1e6 * i++ / rate_hz);
    frame.width_px = picture.cols;
    frame.height_px = picture.rows;
    frame.format = device::PixelFormat::kBgr;
    frame.row_bytes = 3 * picture.cols;
    if (!picture.isContinuous()) picture = picture.clone();
    frame.data.assign(picture.data, picture.data + picture.total() * picture.elemSize());
    return frame;
  };
  if (start_utime == 0) {
    start_utime = std::chrono::duration_cast<std::chrono::microseconds>(
                      std::chrono::system_clock::now().time_since_epoch())
                      .count();
  }
  return std::make_unique<PictureCamera>(std::move(next), 0, start_utime);
}

}  // namespace orchard::io

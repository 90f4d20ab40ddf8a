// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <memory>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>

#include "io/camera/picture_camera.hpp"
#include "io/file_error.hpp"

namespace orchard::io {

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

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/camera/camera_source.hpp"

namespace orchard::io {

/// System calls used for a camera; replaced by a fake in tests. Errors are negative errno values.
class V4l2Calls {
 public:
  virtual ~V4l2Calls() = default;
  virtual int open(const std::string& path) = 0;
  virtual void close(int fileno) = 0;
  virtual int ioctl(int fileno, unsigned long request, void* argument) = 0;
  virtual void* map(int fileno, std::size_t size, std::int64_t offset) = 0;  ///< null on failure
  virtual void unmap(void* memory, std::size_t size) = 0;
  virtual std::int64_t monotonic_us() = 0;
  virtual std::int64_t time_of_day_us() = 0;
};

/// Returns the real system calls.
std::unique_ptr<V4l2Calls> make_v4l2_calls();

/// Requested image size and rate.
struct CameraMode {
  int width_px = 320;
  int height_px = 240;
  double rate_hz = 10.0;
};

/// A Linux camera (Video4Linux2, streaming from mapped buffers). Requests the camera's own JPEG,
/// else uncompressed pixels. After an unplugged cable or another failure it tries to reopen the
/// device every half second.
///
/// The stamp is that of the kernel driver (CLOCK_MONOTONIC, converted to the time of day): the
/// start of exposure if the driver says so (as for USB cameras), else the end of the frame. Half
/// the exposure time is added or subtracted if exposure is manual and known. The remaining constant
/// delay is `camera.delay_s`.
class V4l2Camera : public CameraSource {
 public:
  V4l2Camera(std::string path, const CameraMode& mode,
             std::unique_ptr<V4l2Calls> calls = make_v4l2_calls());
  ~V4l2Camera() override;

  int fileno() const override { return fileno_; }
  Clock::time_point deadline() const override;
  std::optional<device::CameraFrame> take() override;
  std::string problem() const override { return problem_; }
  void restart(const std::string& why) override;
  bool ended() const override { return false; }
  std::int64_t num_damaged() const override { return num_damaged_; }

 private:
  struct Buffer {
    void* memory;
    std::size_t size;
  };
  void open_when_due();
  std::string open();
  std::string choose_format();
  std::string start_streaming();
  void read_exposure();
  void close();
  int call(unsigned long request, void* argument);
  std::string failed(const std::string& what, int code) const;

  std::string path_;
  CameraMode mode_;
  std::unique_ptr<V4l2Calls> calls_;
  int fileno_ = -1;
  bool is_streaming_ = false;
  std::vector<Buffer> buffers_;
  device::PixelFormat format_ = device::PixelFormat::kJpeg;
  int row_bytes_ = 0;
  std::int64_t half_exposure_us_ = 0;
  std::string problem_;
  Clock::time_point next_attempt_ = Clock::now();
  std::int64_t num_damaged_ = 0;
};

}  // namespace orchard::io

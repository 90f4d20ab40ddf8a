// SPDX-License-Identifier: BSD-3-Clause
#include "io/camera/v4l2_camera.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <set>
#include <utility>

namespace orchard::io {
namespace {

using device::PixelFormat;

template <class Clock>
std::int64_t now_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch())
      .count();
}

class KernelCalls : public V4l2Calls {
 public:
  int open(const std::string& path) override {
    const int fileno = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    return fileno >= 0 ? fileno : -errno;
  }
  void close(int fileno) override { ::close(fileno); }
  int ioctl(int fileno, unsigned long request, void* argument) override {
    int result = 0;
    do {
      result = ::ioctl(fileno, request, argument);
    } while (result < 0 && errno == EINTR);
    return result >= 0 ? result : -errno;
  }
  void* map(int fileno, std::size_t size, std::int64_t offset) override {
    void* memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, fileno, offset);
    return memory == MAP_FAILED ? nullptr : memory;
  }
  void unmap(void* memory, std::size_t size) override { munmap(memory, size); }
  // libstdc++'s steady_clock is CLOCK_MONOTONIC, the clock of V4L2's stamps.
  std::int64_t monotonic_us() override { return now_us<std::chrono::steady_clock>(); }
  std::int64_t time_of_day_us() override { return now_us<std::chrono::system_clock>(); }
};

constexpr auto kRetry = std::chrono::milliseconds(500);
constexpr std::uint32_t kNumBuffers = 4;
constexpr std::uint32_t kMaxFormats = 64;

struct Format {
  std::uint32_t fourcc;
  PixelFormat format;
};

/// In order of preference: the formats that need least bandwidth and compression first.
constexpr std::array<Format, 6> kFormats{{{V4L2_PIX_FMT_MJPEG, PixelFormat::kJpeg},
                                          {V4L2_PIX_FMT_JPEG, PixelFormat::kJpeg},
                                          {V4L2_PIX_FMT_YUYV, PixelFormat::kYuyv},
                                          {V4L2_PIX_FMT_GREY, PixelFormat::kGrey},
                                          {V4L2_PIX_FMT_BGR24, PixelFormat::kBgr},
                                          {V4L2_PIX_FMT_RGB24, PixelFormat::kRgb}}};

/// A zero-initialized request structure for capture.
template <class T>
T capture() {
  T request{};
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  return request;
}

}  // namespace

std::unique_ptr<V4l2Calls> make_v4l2_calls() { return std::make_unique<KernelCalls>(); }

V4l2Camera::V4l2Camera(std::string path, const CameraMode& mode, std::unique_ptr<V4l2Calls> calls)
    : path_(std::move(path)), mode_(mode), calls_(std::move(calls)) {
  open_when_due();
}

V4l2Camera::~V4l2Camera() { close(); }

CameraSource::Clock::time_point V4l2Camera::deadline() const {
  return fileno_ < 0 ? next_attempt_ : Clock::time_point::max();
}

std::optional<device::CameraFrame> V4l2Camera::take() {
  open_when_due();
  if (fileno_ < 0) return std::nullopt;
  auto buffer = capture<v4l2_buffer>();
  buffer.memory = V4L2_MEMORY_MMAP;
  if (const int code = call(VIDIOC_DQBUF, &buffer); code < 0) {
    if (code != -EAGAIN) restart(failed("gives no picture", code));
    return std::nullopt;
  }
  std::optional<device::CameraFrame> frame;
  const bool is_known = buffer.index < buffers_.size();
  const bool is_whole = is_known && (buffer.flags & V4L2_BUF_FLAG_ERROR) == 0 &&
                        buffer.bytesused > 0 && buffer.bytesused <= buffers_[buffer.index].size;
  if (is_whole) {
    const auto* data = static_cast<const std::uint8_t*>(buffers_[buffer.index].memory);
    frame.emplace();
    frame->width_px = mode_.width_px;
    frame->height_px = mode_.height_px;
    frame->format = format_;
    frame->row_bytes = row_bytes_;
    frame->data.assign(data, data + buffer.bytesused);
    const std::int64_t now_us = calls_->monotonic_us();
    const bool has_stamp =
        (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    const std::int64_t stamp_us =
        has_stamp ? std::int64_t{buffer.timestamp.tv_sec} * 1'000'000 + buffer.timestamp.tv_usec
                  : now_us;
    const bool is_start =
        has_stamp && (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
    frame->utime = calls_->time_of_day_us() - now_us + stamp_us +
                   (is_start ? half_exposure_us_ : -half_exposure_us_);
  } else {
    ++num_damaged_;
  }
  if (const int code = call(VIDIOC_QBUF, &buffer); code < 0) {
    restart(failed("does not accept a buffer again", code));
  }
  return frame;
}

void V4l2Camera::restart(const std::string& why) {
  close();
  problem_ = why;
  next_attempt_ = Clock::now() + kRetry;
}

void V4l2Camera::open_when_due() {
  if (fileno_ >= 0 || Clock::now() < next_attempt_) return;
  const std::string why = open();
  if (why.empty()) {
    problem_.clear();
  } else {
    restart(why);
  }
}

std::string V4l2Camera::open() {
  const int fileno = calls_->open(path_);
  if (fileno < 0) return failed("cannot be opened", fileno);
  fileno_ = fileno;
  v4l2_capability capability{};
  if (const int code = call(VIDIOC_QUERYCAP, &capability); code < 0) {
    return failed("is not a camera", code);
  }
  const std::uint32_t can = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0
                                ? capability.device_caps
                                : capability.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0) {
    return path_ + " does not stream pictures; use the first device of the camera";
  }
  if (std::string why = choose_format(); !why.empty()) return why;
  auto rate = capture<v4l2_streamparm>();
  rate.parm.capture.timeperframe = {1000,
                                    static_cast<std::uint32_t>(std::lround(1000 * mode_.rate_hz))};
  call(VIDIOC_S_PARM, &rate);  // a camera with a fixed rate keeps it
  read_exposure();
  return start_streaming();
}

std::string V4l2Camera::choose_format() {
  std::set<std::uint32_t> offered;
  for (std::uint32_t i = 0; i < kMaxFormats; ++i) {
    auto description = capture<v4l2_fmtdesc>();
    description.index = i;
    if (call(VIDIOC_ENUM_FMT, &description) < 0) break;
    offered.insert(description.pixelformat);
  }
  for (const Format& wanted : kFormats) {
    if (offered.count(wanted.fourcc) == 0) continue;
    auto format = capture<v4l2_format>();
    format.fmt.pix.width = static_cast<std::uint32_t>(mode_.width_px);
    format.fmt.pix.height = static_cast<std::uint32_t>(mode_.height_px);
    format.fmt.pix.pixelformat = wanted.fourcc;
    format.fmt.pix.field = V4L2_FIELD_ANY;
    if (const int code = call(VIDIOC_S_FMT, &format); code < 0) {
      return failed("accepts no picture format", code);
    }
    const v4l2_pix_format& got = format.fmt.pix;
    if (got.pixelformat != wanted.fourcc) continue;
    if (static_cast<int>(got.width) != mode_.width_px ||
        static_cast<int>(got.height) != mode_.height_px) {
      return path_ + " gives " + std::to_string(got.width) + "x" + std::to_string(got.height) +
             ", but camera.width_px and height_px are " + std::to_string(mode_.width_px) + "x" +
             std::to_string(mode_.height_px);
    }
    format_ = wanted.format;
    row_bytes_ = static_cast<int>(got.bytesperline);
    return {};
  }
  return path_ + " offers none of the formats MJPEG, YUYV, GREY, BGR and RGB";
}

std::string V4l2Camera::start_streaming() {
  auto request = capture<v4l2_requestbuffers>();
  request.count = kNumBuffers;
  request.memory = V4L2_MEMORY_MMAP;
  if (const int code = call(VIDIOC_REQBUFS, &request); code < 0) {
    return failed("provides no buffers; is another program using it?", code);
  }
  for (std::uint32_t i = 0; i < request.count; ++i) {
    auto buffer = capture<v4l2_buffer>();
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = i;
    if (const int code = call(VIDIOC_QUERYBUF, &buffer); code < 0) {
      return failed("does not describe its buffers", code);
    }
    void* memory = calls_->map(fileno_, buffer.length, buffer.m.offset);
    if (memory == nullptr) return path_ + ": its buffers cannot be mapped";
    buffers_.push_back({memory, buffer.length});
    if (const int code = call(VIDIOC_QBUF, &buffer); code < 0) {
      return failed("does not accept a buffer", code);
    }
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (const int code = call(VIDIOC_STREAMON, &type); code < 0)
    return failed("does not start streaming", code);
  is_streaming_ = true;
  return {};
}

void V4l2Camera::read_exposure() {
  half_exposure_us_ = 0;
  v4l2_control mode{V4L2_CID_EXPOSURE_AUTO, 0};
  v4l2_control time{V4L2_CID_EXPOSURE_ABSOLUTE, 0};  // in units of 100 us
  if (call(VIDIOC_G_CTRL, &mode) < 0 || call(VIDIOC_G_CTRL, &time) < 0) return;
  const bool is_set =
      mode.value == V4L2_EXPOSURE_MANUAL || mode.value == V4L2_EXPOSURE_SHUTTER_PRIORITY;
  if (is_set && time.value > 0 && time.value < 10000) half_exposure_us_ = 50 * time.value;
}

void V4l2Camera::close() {
  if (fileno_ < 0) return;
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (is_streaming_) call(VIDIOC_STREAMOFF, &type);
  for (const Buffer& buffer : buffers_) calls_->unmap(buffer.memory, buffer.size);
  buffers_.clear();
  calls_->close(fileno_);
  fileno_ = -1;
  is_streaming_ = false;
}

int V4l2Camera::call(unsigned long request, void* argument) {
  return calls_->ioctl(fileno_, request, argument);
}

std::string V4l2Camera::failed(const std::string& what, int code) const {
  return path_ + " " + what + ": " + std::strerror(-code);
}

}  // namespace orchard::io

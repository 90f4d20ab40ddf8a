// SPDX-License-Identifier: BSD-3-Clause
// A kernel that plays a camera, by the rules of the Video4Linux2 API's documentation.
#include "io/camera/v4l2_camera.hpp"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <cerrno>
#include <deque>
#include <set>
#include <vector>

namespace orchard::io {
namespace {

struct FakeFrame {
  std::vector<std::uint8_t> data;
  std::int64_t stamp_us = 0;
  std::uint32_t flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
};

/// What the camera is and does; shared with the test.
struct FakeCamera {
  bool is_plugged_in = true;
  std::vector<std::uint32_t> formats{V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_MJPEG};
  std::uint32_t width_px = 320, height_px = 240;
  std::int32_t exposure_mode = V4L2_EXPOSURE_MANUAL, exposure_100us = 80;
  std::deque<FakeFrame> frames;
  std::int64_t monotonic_us = 5'000'000;
  std::int64_t realtime_us = 1'700'000'000'000'000;

  bool is_open = false, is_streaming = false;
  std::uint32_t format = 0;
  double rate_hz = 0.0;
  std::vector<std::vector<std::uint8_t>> memory;
  std::deque<std::uint32_t> queued;
  std::set<void*> mapped;
  int num_opened = 0;
};

class FakeCalls : public V4l2Calls {
 public:
  explicit FakeCalls(FakeCamera& camera) : camera_(camera) {}

  int open(const std::string&) override {
    if (!camera_.is_plugged_in) return -ENOENT;
    camera_.is_open = true;
    ++camera_.num_opened;
    return 42;
  }
  void close(int) override {
    EXPECT_TRUE(camera_.mapped.empty()) << "buffers are still mapped";
    camera_.is_open = camera_.is_streaming = false;
    camera_.queued.clear();
  }
  void* map(int, std::size_t size, std::int64_t offset) override {
    auto& buffer = camera_.memory.at(static_cast<std::size_t>(offset));
    EXPECT_EQ(size, buffer.size());
    camera_.mapped.insert(buffer.data());
    return buffer.data();
  }
  void unmap(void* memory, std::size_t) override { EXPECT_EQ(camera_.mapped.erase(memory), 1u); }
  std::int64_t monotonic_us() override { return camera_.monotonic_us; }
  std::int64_t time_of_day_us() override { return camera_.realtime_us; }

  int ioctl(int, unsigned long request, void* argument) override {
    if (!camera_.is_plugged_in) return -ENODEV;
    switch (request) {
      case VIDIOC_QUERYCAP: {
        auto& c = *static_cast<v4l2_capability*>(argument);
        c.capabilities = V4L2_CAP_DEVICE_CAPS | V4L2_CAP_VIDEO_CAPTURE;
        c.device_caps = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
        return 0;
      }
      case VIDIOC_ENUM_FMT: {
        auto& d = *static_cast<v4l2_fmtdesc*>(argument);
        if (d.index >= camera_.formats.size()) return -EINVAL;
        d.pixelformat = camera_.formats[d.index];
        return 0;
      }
      case VIDIOC_S_FMT: {
        auto& f = static_cast<v4l2_format*>(argument)->fmt.pix;
        f.width = camera_.width_px;  // the nearest that it has
        f.height = camera_.height_px;
        f.bytesperline = f.pixelformat == V4L2_PIX_FMT_YUYV ? 2 * f.width : 0;
        camera_.format = f.pixelformat;
        return 0;
      }
      case VIDIOC_S_PARM: {
        const auto& fraction = static_cast<v4l2_streamparm*>(argument)->parm.capture.timeperframe;
        camera_.rate_hz = static_cast<double>(fraction.denominator) / fraction.numerator;
        return 0;
      }
      case VIDIOC_G_CTRL: {
        auto& c = *static_cast<v4l2_control*>(argument);
        c.value = c.id == V4L2_CID_EXPOSURE_AUTO ? camera_.exposure_mode : camera_.exposure_100us;
        return 0;
      }
      case VIDIOC_REQBUFS: {
        auto& r = *static_cast<v4l2_requestbuffers*>(argument);
        r.count = 3;  // fewer than asked for
        camera_.memory.assign(r.count, std::vector<std::uint8_t>(100'000));
        return 0;
      }
      case VIDIOC_QUERYBUF: {
        auto& b = *static_cast<v4l2_buffer*>(argument);
        b.length = 100'000;
        b.m.offset = b.index;
        return 0;
      }
      case VIDIOC_QBUF:
        camera_.queued.push_back(static_cast<v4l2_buffer*>(argument)->index);
        return 0;
      case VIDIOC_STREAMON:
        camera_.is_streaming = true;
        return 0;
      case VIDIOC_STREAMOFF:
        return 0;
      case VIDIOC_DQBUF:
        return dequeue(*static_cast<v4l2_buffer*>(argument));
      default:
        return -ENOTTY;
    }
  }

 private:
  int dequeue(v4l2_buffer& buffer) {
    if (camera_.frames.empty()) return -EAGAIN;
    EXPECT_FALSE(camera_.queued.empty()) << "a buffer was not given back";
    if (camera_.queued.empty()) return -EAGAIN;
    const FakeFrame frame = camera_.frames.front();
    camera_.frames.pop_front();
    buffer.index = camera_.queued.front();
    camera_.queued.pop_front();
    std::copy(frame.data.begin(), frame.data.end(), camera_.memory[buffer.index].begin());
    buffer.bytesused = static_cast<std::uint32_t>(frame.data.size());
    buffer.flags = frame.flags;
    buffer.timestamp.tv_sec = frame.stamp_us / 1'000'000;
    buffer.timestamp.tv_usec = frame.stamp_us % 1'000'000;
    return 0;
  }

  FakeCamera& camera_;
};

V4l2Camera open(FakeCamera& camera, const CameraMode& mode = {}) {
  return V4l2Camera("/dev/video7", mode, std::make_unique<FakeCalls>(camera));
}

TEST(V4l2Camera, TakesTheCamerasOwnJpegAtItsStartOfExposure) {
  FakeCamera camera;
  V4l2Camera source = open(camera, {320, 240, 7.5});
  EXPECT_EQ(source.problem(), "");
  EXPECT_TRUE(camera.is_streaming);
  EXPECT_EQ(camera.format, static_cast<std::uint32_t>(V4L2_PIX_FMT_MJPEG));
  EXPECT_DOUBLE_EQ(camera.rate_hz, 7.5);
  EXPECT_EQ(source.fileno(), 42);
  EXPECT_FALSE(source.take());
  for (int i = 0; i < 20; ++i) {
    // Exposed from 40 ms ago on, for 8 ms.
    camera.frames.push_back({{1, 2, static_cast<std::uint8_t>(i)}, camera.monotonic_us - 40'000});
    const auto frame = source.take();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->data, (std::vector<std::uint8_t>{1, 2, static_cast<std::uint8_t>(i)}));
    EXPECT_EQ(frame->utime, camera.realtime_us - 40'000 + 4'000);
    EXPECT_EQ(frame->format, device::PixelFormat::kJpeg);
    camera.monotonic_us += 100'000;
    camera.realtime_us += 100'000;
  }
  EXPECT_EQ(source.num_damaged(), 0);
}

TEST(V4l2Camera, OtherStampsAreReadAsTheirFlagsSay) {
  FakeCamera camera;
  V4l2Camera source = open(camera);
  camera.frames.push_back({{1}, camera.monotonic_us - 40'000, V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC});
  EXPECT_EQ(source.take()->utime, camera.realtime_us - 40'000 - 4'000);  // of the end
  camera.frames.push_back({{1}, 12345, V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN});
  EXPECT_EQ(source.take()->utime, camera.realtime_us - 4'000);
  FakeCamera automatic;
  automatic.exposure_mode = V4L2_EXPOSURE_AUTO;  // nobody knows how long
  V4l2Camera unknown = open(automatic);
  automatic.frames.push_back({{1}, automatic.monotonic_us - 40'000});
  EXPECT_EQ(unknown.take()->utime, automatic.realtime_us - 40'000);
}

TEST(V4l2Camera, TakesPixelsWhereThereIsNoJpeg) {
  FakeCamera camera;
  camera.formats = {V4L2_PIX_FMT_NV12, V4L2_PIX_FMT_YUYV};
  V4l2Camera source = open(camera);
  camera.frames.push_back({std::vector<std::uint8_t>(1000, 7), camera.monotonic_us});
  const auto frame = source.take();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->format, device::PixelFormat::kYuyv);
  EXPECT_EQ(frame->row_bytes, 640);
}

TEST(V4l2Camera, SaysWhatIsWrong) {
  FakeCamera other_size;
  other_size.width_px = 640;
  other_size.height_px = 480;
  EXPECT_EQ(open(other_size).problem(),
            "/dev/video7 gives 640x480, but camera.width_px and height_px are 320x240");
  FakeCamera strange;
  strange.formats = {V4L2_PIX_FMT_NV12};
  EXPECT_EQ(open(strange).problem(),
            "/dev/video7 offers none of the formats MJPEG, YUYV, GREY, BGR and RGB");
  FakeCamera absent;
  absent.is_plugged_in = false;
  EXPECT_EQ(open(absent).problem(), "/dev/video7 cannot be opened: No such file or directory");
}

TEST(V4l2Camera, DamagedPicturesAreCountedAndTheirBuffersGivenBack) {
  FakeCamera camera;
  V4l2Camera source = open(camera);
  for (int i = 0; i < 10; ++i) {
    camera.frames.push_back({{1}, 1, V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_ERROR});
    EXPECT_FALSE(source.take());
    camera.frames.push_back({{}, 1});
    EXPECT_FALSE(source.take());
  }
  EXPECT_EQ(source.num_damaged(), 20);
  camera.frames.push_back({{9}, 1});
  EXPECT_TRUE(source.take());
}

TEST(V4l2Camera, IsOpenedAgainWhenItComesBack) {
  FakeCamera camera;
  V4l2Camera source = open(camera);
  camera.is_plugged_in = false;
  EXPECT_FALSE(source.take());
  EXPECT_EQ(source.fileno(), -1);
  EXPECT_EQ(source.problem(), "/dev/video7 gives no picture: No such device");
  EXPECT_TRUE(camera.mapped.empty());
  camera.is_plugged_in = true;
  camera.frames.push_back({{5}, 1});
  std::optional<device::CameraFrame> frame;
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!frame && std::chrono::steady_clock::now() < give_up) frame = source.take();
  ASSERT_TRUE(frame);
  EXPECT_EQ(source.problem(), "");
  EXPECT_EQ(camera.num_opened, 2);
}

}  // namespace
}  // namespace orchard::io

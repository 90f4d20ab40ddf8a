// SPDX-License-Identifier: BSD-3-Clause
// A folder of pictures and a log as cameras; a camera that hangs.
#include "camera_driver/camera_driver.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "bus/messages/codec.hpp"
#include "io/file_error.hpp"
#include "io/log/log_writer.hpp"

namespace orchard::procs {
namespace {

using Clock = bus::Driver::Clock;

std::vector<std::uint8_t> jpeg(int i, int width_px = 320, int height_px = 240) {
  std::vector<std::uint8_t> data;
  cv::imencode(".jpg", cv::Mat(height_px, width_px, CV_8UC3, cv::Scalar(i % 250, 100, 200)), data);
  return data;
}

std::int64_t time_of_day_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// Steps the driver when it wants to be, until it has ended; never longer than a minute.
std::vector<vision::Image> run(CameraDriver& driver) {
  std::vector<vision::Image> images;
  const auto give_up = Clock::now() + std::chrono::minutes(1);
  while (!driver.ended() && Clock::now() < give_up) {
    std::this_thread::sleep_until(std::min(driver.deadline(), give_up));
    driver.step([&](bus::Message m) { images.push_back(std::get<vision::Image>(std::move(m))); });
  }
  return images;
}

class CameraDriverTest : public ::testing::Test {
 protected:
  CameraDriverTest()
      : folder_(std::filesystem::temp_directory_path() /
                ("orchard_camera_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~CameraDriverTest() override { std::filesystem::remove_all(folder_); }

  void write_picture(std::int64_t utime, const std::vector<std::uint8_t>& data) {
    std::ofstream file(folder_ / (std::to_string(utime) + ".jpg"), std::ios::binary);
    file.write(reinterpret_cast<const char*>(data.data()),
               static_cast<std::streamsize>(data.size()));
  }

  std::unique_ptr<CameraDriver> play_folder() {
    config_.drivers.camera.device = "pictures:" + folder_.string();
    return make_camera_driver({}, config_);
  }

  std::filesystem::path folder_;
  io::Config config_;
};

TEST_F(CameraDriverTest, PicturesOfAFolderComeUnchangedAndAtTheirPace) {
  for (int i = 0; i < 5; ++i) write_picture(1'000'000 + 120'000 * i, jpeg(i));
  const std::int64_t begin = time_of_day_us();
  const auto driver = play_folder();
  const auto images = run(*driver);
  ASSERT_EQ(images.size(), 5u);
  for (int i = 0; i < 5; ++i) {
    const vision::Image& image = images[static_cast<std::size_t>(i)];
    EXPECT_EQ(image.data, jpeg(i));
    EXPECT_EQ(image.seq, i);
    EXPECT_EQ(image.utime - images[0].utime, 120'000 * i);
  }
  EXPECT_GE(images[0].utime, begin);
  EXPECT_GE(time_of_day_us() - begin, 480'000);
  EXPECT_EQ(driver->condition().text, "");
}

TEST_F(CameraDriverTest, PicturesOfTheNearFutureKeepTheirTimes) {
  const std::int64_t soon = time_of_day_us() + 300'000;
  write_picture(soon, jpeg(1));
  write_picture(soon + 100'000, jpeg(2));
  const auto images = run(*play_folder());
  ASSERT_EQ(images.size(), 2u);
  EXPECT_EQ(images[0].utime, soon);
  EXPECT_EQ(images[1].utime, soon + 100'000);
}

TEST_F(CameraDriverTest, NotMoreThanTheRateThatWasAskedFor) {
  for (int i = 0; i < 30; ++i) write_picture(1'000'000 + 10'000 * i, jpeg(i));
  config_.drivers.camera.rate_hz = 20.0;
  const auto images = run(*play_folder());
  ASSERT_EQ(images.size(), 6u);
  for (std::size_t i = 1; i < images.size(); ++i) {
    EXPECT_EQ(images[i].utime - images[i - 1].utime, 50'000);
  }
}

TEST_F(CameraDriverTest, APictureOfAnotherSizeIsRefusedAndNamed) {
  write_picture(1'000'000, jpeg(1, 640, 480));
  const auto driver = play_folder();
  EXPECT_TRUE(run(*driver).empty());
  EXPECT_EQ(driver->condition().num_bad, 1);
  EXPECT_NE(driver->condition().text.find("640x480, but camera.width_px and height_px are 320x240"),
            std::string::npos);
}

TEST_F(CameraDriverTest, TheSamePictureTenTimesIsAFrozenCamera) {
  for (int i = 0; i < 10; ++i) write_picture(1'000'000 + 1000 * i, jpeg(7));
  const auto driver = play_folder();
  run(*driver);
  EXPECT_NE(driver->condition().text.find("frozen"), std::string::npos);
  EXPECT_EQ(driver->condition().level, bus::Level::kError);
}

TEST_F(CameraDriverTest, APictureOfALogIsWhatTheLogHolds) {
  vision::Image image;
  image.utime = 50'000'000;
  image.width_px = 320;
  image.height_px = 240;
  image.data = jpeg(3);
  const std::string path = (folder_ / "drive.lcm").string();
  io::LogWriter writer(path);
  pose::Odometry first;
  first.utime = 49'900'000;
  writer.write(first.utime, bus::info(bus::Channel::kOdometry).name, bus::encode(first));
  writer.write(image.utime, bus::info(bus::Channel::kImage).name, bus::encode(image));
  writer.close();
  CameraDriverOptions options;
  options.emulate = path;
  const std::int64_t start = time_of_day_us() + 200'000;
  options.emulate_at = std::to_string(start);
  const auto images = run(*make_camera_driver(options, config_));
  ASSERT_EQ(images.size(), 1u);
  EXPECT_EQ(images[0].utime, start + 100'000);  // after the log's first event
  EXPECT_EQ(images[0].data, image.data);
}

TEST_F(CameraDriverTest, SourcesThatAreNone) {
  EXPECT_THROW(play_folder(), io::FileError);  // empty
  config_.drivers.camera.device = "webcam";
  EXPECT_THROW(make_camera_driver({}, config_), std::invalid_argument);
  config_.drivers.camera.device = (folder_ / "video0").string();
  const auto absent = make_camera_driver({}, config_);  // it may be plugged in later
  EXPECT_NE(absent->condition().text.find("No such file"), std::string::npos);
  EXPECT_EQ(absent->condition().level, bus::Level::kError);
}

/// A camera that is open and silent.
class SilentCamera : public io::CameraSource {
 public:
  explicit SilentCamera(int& num_restarts) : num_restarts_(num_restarts) {}
  int fileno() const override { return 0; }
  Clock::time_point deadline() const override { return Clock::time_point::max(); }
  std::optional<device::CameraFrame> take() override { return std::nullopt; }
  std::string problem() const override { return {}; }
  void restart(const std::string&) override { ++num_restarts_; }
  bool ended() const override { return num_restarts_ == 1; }

 private:
  int& num_restarts_;
};

TEST_F(CameraDriverTest, ASilentCameraIsOpenedAgain) {
  int num_restarts = 0;
  CameraDriver driver(std::make_unique<SilentCamera>(num_restarts), config_.drivers.camera, 320,
                      240);
  run(driver);
  EXPECT_EQ(num_restarts, 1);
}

}  // namespace
}  // namespace orchard::procs

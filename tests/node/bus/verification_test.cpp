// SPDX-License-Identifier: BSD-3-Clause
#include "log_player/verification.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "io/file_error.hpp"
#include "node/bus/fake_log.hpp"

namespace orchard::procs {
namespace {

using bus::Channel;

class VerificationTest : public ::testing::Test {
 protected:
  VerificationTest() {
    path_ = (std::filesystem::path(::testing::TempDir()) /
             (std::string("orchard_verify_") +
              ::testing::UnitTest::GetInstance()->current_test_info()->name()))
                .string();
    for (int i = 0; i < 5; ++i) {
      pose::PoseEstimate estimate;
      estimate.utime = 1000 + i;
      estimate.seq = i;
      poses_.push_back(bus::encode(estimate));
    }
  }
  ~VerificationTest() override { std::filesystem::remove(path_); }

  /// Compares the recording of the first `num_recorded` with `now`.
  Verification compare(std::size_t num_recorded,
                       const std::vector<std::vector<std::uint8_t>>& now) {
    io::LogWriter writer(path_);
    for (std::size_t i = 0; i < num_recorded; ++i) writer.write(1, "POSE", poses_[i]);
    writer.close();
    Verification verification(path_);
    for (const auto& bytes : now) verification.take(Channel::kPose, bytes);
    verification.finish();
    return verification;
  }

  std::string path_;
  std::vector<std::vector<std::uint8_t>> poses_;
};

TEST_F(VerificationTest, TheSameIsEqual) { EXPECT_TRUE(compare(5, poses_).equal()); }

TEST_F(VerificationTest, OneChangedByteIsFoundAndNamed) {
  auto now = poses_;
  now[3][40] ^= 1;
  const Verification verification = compare(5, now);
  EXPECT_FALSE(verification.equal());
  EXPECT_THAT(verification.describe(),
              ::testing::Contains(::testing::AllOf(::testing::HasSubstr("POSE seq 3 utime 1003"),
                                                   ::testing::HasSubstr("byte 40"))));
}

TEST_F(VerificationTest, RecordingThatStoppedEarlyIsANote) {
  const Verification verification = compare(3, poses_);
  EXPECT_TRUE(verification.equal());
  EXPECT_THAT(verification.describe(), ::testing::Contains(::testing::HasSubstr("note: POSE: 2")));
}

TEST_F(VerificationTest, RecordedButNotMadeAgainIsADifference) {
  EXPECT_FALSE(compare(5, {poses_.begin(), poses_.begin() + 4}).equal());
}

TEST_F(VerificationTest, MadeButMissingInTheMiddleIsADifference) {
  std::swap(poses_[1], poses_[4]);
  auto now = poses_;
  std::swap(now[1], now[4]);
  EXPECT_FALSE(compare(4, now).equal());  // recorded 0, 4, 2, 3
}

TEST_F(VerificationTest, LogWithoutDerivedMessagesIsRefused) {
  bus::testing::write_log(path_, bus::testing::fake_drive(1));
  EXPECT_THROW(Verification{path_}, io::FileError);
}

}  // namespace
}  // namespace orchard::procs

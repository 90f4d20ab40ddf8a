// SPDX-License-Identifier: BSD-3-Clause
//
// Any bytes as one of libbot's messages. The first byte chooses the type, whose hash is put in
// place. What is translated passes the guard of the bus.
#include <cstdlib>

#include "bot_core/gps_data_t.hpp"
#include "bot_core/image_t.hpp"
#include "bot_core/planar_lidar_t.hpp"
#include "bot_core/pose_t.hpp"
#include "bus/bot_core/bot_core_driver.hpp"
#include "bus/messages/codec.hpp"
#include "bus/messages/field_codec.hpp"
#include "fuzz/fuzz_seeds.hpp"

using namespace orchard;

namespace {

std::int64_t hash_of(int type) {
  const std::int64_t hashes[] = {bot_core::planar_lidar_t::getHash(), bot_core::image_t::getHash(),
                                 bot_core::pose_t::getHash(), bot_core::gps_data_t::getHash()};
  return hashes[type % 4];
}

template <class M>
std::string seed(char type, const M& message) {
  std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return type + bytes.substr(8);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  std::vector<std::uint8_t> bytes = bus::FieldWriter(hash_of(data[0])).bytes();
  bytes.insert(bytes.end(), data + 1, data + size);
  for (const auto pose_as : {device::BotPoseAs::kOdometry, device::BotPoseAs::kPoseFix}) {
    device::BotCoreConfig config;
    config.pose_as = pose_as;
    bus::BotCoreTranslator translator(config, 3000);
    for (int i = 0; i < 2; ++i) {
      const auto message = translator.translate("A", bytes.data(), bytes.size());
      if (!message) continue;
      const auto encoded = bus::encode(*message);
      const auto decoded = bus::decode(bus::channel_of(*message), encoded.data(), encoded.size());
      if (std::holds_alternative<bus::Rejection>(decoded)) std::abort();
    }
  }
  return 0;
}

namespace orchard::fuzz {

std::vector<std::string> seeds() {
  bot_core::planar_lidar_t lidar;
  lidar.utime = 1'700'000'000'123'456;
  lidar.nranges = 3;
  lidar.ranges = {1.0f, 2.0f, 0.0f};
  lidar.nintensities = 3;
  lidar.intensities = {1, 2, 3};
  lidar.rad0 = -1.5f;
  lidar.radstep = 0.25f;
  bot_core::pose_t pose{};
  pose.utime = 7;
  pose.orientation[0] = 1.0;
  pose.vel[0] = 0.5;
  bot_core::gps_data_t gps{};
  gps.utime = 9;
  gps.gps_lock = 3;
  gps.latitude = -32.4;
  bot_core::image_t image{};
  image.utime = 5;
  image.width = 4;
  image.height = 2;
  image.row_stride = 12;
  image.pixelformat = 861030210;  // BGR3
  image.size = 24;
  image.data.assign(24, 7);
  image.nmetadata = 1;
  image.metadata.resize(1);
  image.metadata[0] = {"key", 2, {1, 2}};
  bot_core::image_t yuyv = image;
  yuyv.row_stride = 8;
  yuyv.pixelformat = 1448695129;
  return {seed(0, lidar), seed(1, image), seed(1, yuyv), seed(2, pose), seed(3, gps)};
}

}  // namespace orchard::fuzz

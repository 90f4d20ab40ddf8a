// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "bus/messages/codec.hpp"
#include "io/log/log_writer.hpp"

namespace orchard::bus::testing {

inline constexpr std::int64_t kLogStart = 1700000000000000;

/// The head of a JPEG of 320x240, filled up to `num_bytes`.
inline vision::Image fake_image(std::int64_t utime, std::int32_t seq, std::size_t num_bytes) {
  vision::Image image;
  image.utime = utime;
  image.seq = seq;
  image.width_px = 320;
  image.height_px = 240;
  image.data = {0xFF, 0xD8, 0xFF, 0xC0, 0, 17, 8, 0, 240, 1, 64};
  image.data.resize(std::max<std::size_t>(num_bytes, 32), 0x55);
  return image;
}

/// What a robot sends in `num_tenths` tenths of a second: 10 Hz scans and pictures, 50 Hz odometry.
inline std::vector<Message> fake_drive(int num_tenths, std::size_t image_bytes = 12000) {
  std::vector<Message> messages;
  for (int i = 0; i < num_tenths; ++i) {
    const std::int64_t utime = kLogStart + 100000LL * i;
    laser::Scan scan;
    scan.utime = utime;
    scan.seq = i;
    scan.bearing_min_rad = -2.0;
    scan.bearing_step_rad = 0.006;
    scan.range_max_m = 5.6;
    scan.ranges_m.assign(682, 1.0f + 0.001f * static_cast<float>(i % 1000));
    messages.push_back(scan);
    messages.push_back(fake_image(utime + 3000, i, image_bytes));
    for (int k = 0; k < 5; ++k) {
      pose::Odometry odometry;
      odometry.utime = utime + 20000LL * k + 7000;
      odometry.seq = 5 * i + k;
      odometry.speed_mps = 1.0 + 0.01 * ((5 * i + k) % 17);
      messages.push_back(odometry);
    }
  }
  return messages;
}

inline void write_log(const std::string& path, const std::vector<Message>& messages) {
  io::LogWriter writer(path);
  for (const Message& message : messages) {
    writer.write(utime_of(message), info(channel_of(message)).name, encode(message));
  }
  writer.close();
}

}  // namespace orchard::bus::testing

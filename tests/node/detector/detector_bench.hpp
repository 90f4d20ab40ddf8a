// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "bus/messages/codec.hpp"
#include "detector/detector_node.hpp"
#include "unit/detection/tube_rig.hpp"

namespace orchard::procs {

inline std::vector<test::Tube> scene(int i) {
  return {test::brown_tube(2.0 - 0.02 * i, 0.4), test::brown_tube(1.6 - 0.02 * i, -0.4),
          test::blue_tube(2.2 - 0.02 * i, 0.0)};
}

inline laser::Scan scan(int i) {
  laser::Scan s = test::scan_of(scene(i), 1'000'000 + 100'000 * i);
  s.seq = i;
  return s;
}

inline vision::Image picture(int i, std::int64_t offset_us = 20'000) {
  const auto rig = test::tube_rig();
  vision::Image image = test::picture_of_tubes(scene(i), rig, 1'000'000 + 100'000 * i + offset_us);
  const cv::Mat raw(image.height_px, image.width_px, CV_8UC3, image.data.data());
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", raw, jpeg, {cv::IMWRITE_JPEG_QUALITY, 88});
  image.encoding = vision::Encoding::kJpeg;
  image.data = jpeg;
  image.seq = i;
  return image;
}

/// A node and what it sent.
struct Bench {
  explicit Bench(const io::Config& config = {}) : node(config) {}
  void handle(bus::Message message) { node.handle(message, outbox()); }
  void flush() { node.flush(outbox()); }
  bus::Outbox outbox() {
    return [this](bus::Message m) {
      all.push_back(bus::encode(m));
      if (const auto* detections = std::get_if<detection::Detections>(&m))
        sent.push_back(*detections);
    };
  }
  DetectorNode node;
  std::vector<detection::Detections> sent;
  std::vector<std::vector<std::uint8_t>> all;  ///< bytes of everything sent, in order
};

}  // namespace orchard::procs

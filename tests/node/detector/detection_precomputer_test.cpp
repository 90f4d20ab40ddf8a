// SPDX-License-Identifier: BSD-3-Clause
#include "detector/detection_precomputer.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "node/detector/detector_bench.hpp"

namespace orchard::procs {
namespace {

/// What a drive gives when all that can be foreseen is computed ahead of its turn by `ahead`
/// inputs, and how many inputs gave something to compute.
std::pair<std::vector<std::vector<std::uint8_t>>, int> sent_ahead(
    const io::Config& config, const std::vector<bus::Message>& inputs, std::size_t ahead) {
  Bench bench(config);
  std::deque<std::unique_ptr<bus::Precomputation>> precomputed;
  int num_pairs = 0;
  for (std::size_t i = 0, next = 0; i < inputs.size(); ++i) {
    for (; next < inputs.size() && next <= i + ahead; ++next) {
      precomputed.push_back(bench.node.precompute(inputs[next]));
      if (!precomputed.back()) continue;
      precomputed.back()->compute();
      const auto& detections = dynamic_cast<const PrecomputedDetections&>(*precomputed.back());
      num_pairs += static_cast<int>(detections.pairs.size()) + (detections.alone ? 1 : 0);
    }
    bench.node.use_precomputed(std::move(precomputed.front()));
    precomputed.pop_front();
    bench.handle(inputs[i]);
  }
  bench.flush();
  bench.all.push_back({});
  for (const char c : bench.node.warning()) {
    bench.all.back().push_back(static_cast<std::uint8_t>(c));
  }
  return {bench.all, num_pairs};
}

std::vector<std::vector<std::uint8_t>> sent_in_turn(const io::Config& config,
                                                    const std::vector<bus::Message>& inputs) {
  Bench bench(config);
  for (const bus::Message& input : inputs) bench.handle(input);
  bench.flush();
  bench.all.push_back({});
  for (const char c : bench.node.warning()) {
    bench.all.back().push_back(static_cast<std::uint8_t>(c));
  }
  return bench.all;
}

TEST(DetectionPrecomputer, WhatIsComputedAheadChangesNothing) {
  std::vector<bus::Message> inputs;
  for (int i = 0; i < 40; ++i) {
    inputs.push_back(scan(i));
    if (i % 7 == 3) continue;  // without a picture
    vision::Image image = picture(i);
    if (i == 20) image.data.resize(100);
    inputs.push_back(pose::Odometry{image.utime - 3000, i, 0.3, 0.02 * i, {}});
    inputs.push_back(std::move(image));
  }
  io::Config alone;
  alone.camera.enabled = false;
  io::Config moving;
  moving.detector.use_odometry = true;
  for (const io::Config& config : {io::Config{}, alone, moving}) {
    const auto expected = sent_in_turn(config, inputs);
    for (const std::size_t ahead : {std::size_t{0}, std::size_t{5}, std::size_t{1000}}) {
      const auto [sent, num_pairs] = sent_ahead(config, inputs, ahead);
      EXPECT_EQ(sent, expected);
      EXPECT_GT(num_pairs, 30u);
    }
  }
}

}  // namespace
}  // namespace orchard::procs

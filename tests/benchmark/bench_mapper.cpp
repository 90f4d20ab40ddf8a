// SPDX-License-Identifier: BSD-3-Clause
// Mapper::update along a robot's path on a map of 1e6 landmarks against one of 1e3; prints the
// ratio of one run, and the bytes per landmark at 1e6.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>

#include "mapping/mapper.hpp"
#include "result_line.hpp"

namespace {

using orchard::detection::Detection;
using orchard::detection::Detections;
using orchard::detection::Label;
using orchard::mapping::Mapper;
using orchard::pose::PoseEstimate;

constexpr double kRow_m = 4.0;
constexpr double kTree_m = 3.0;

Detection tree_at(double x_m, double y_m) {
  Detection d;
  d.centre_x_m = x_m;
  d.centre_y_m = y_m;
  d.covariance = {1e-4, 0.0, 1e-4};
  d.width_m = 0.2;
  d.width_sd_m = 0.02;
  d.label = Label::kTree;
  d.roc_tree = 0.9f;
  return d;
}

/// A square orchard of `n` trees in rows along x.
Mapper orchard_of(int n) {
  orchard::mapping::MapperConfig config;
  config.align_scans = false;
  const int side = static_cast<int>(std::lround(std::sqrt(n)));
  Mapper mapper(config);
  for (int row = 0; row < side; ++row) {
    Detections detections;
    PoseEstimate pose;
    pose.y_m = kRow_m * row;
    for (int block = 0; block < side; block += 20) {
      detections.trunks.clear();
      pose.x_m = kTree_m * block;
      for (int k = 0; k < 20 && block + k < side; ++k) {
        detections.trunks.push_back(tree_at(kTree_m * k, 0.0));
      }
      mapper.update(detections, pose);
    }
  }
  return mapper;
}

std::map<int, double>& best_seconds() {
  static std::map<int, double> best;
  return best;
}
double bytes_per_landmark = 0.0;

/// One drive between two rows, 0.25 m a scan, six trees of each row in view.
void drive(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  Mapper mapper = orchard_of(n);
  const int side = static_cast<int>(std::lround(std::sqrt(n)));
  bytes_per_landmark = static_cast<double>(mapper.num_bytes()) /
                       static_cast<double>(mapper.num_landmarks());
  const int num_steps = 300;
  int lane = 0;
  for (auto _ : state) {
    const double y_m = kRow_m * (side / 2 + lane++ % (side / 4) + 0.5);
    const auto start = std::chrono::steady_clock::now();
    for (int step = 0; step < num_steps; ++step) {
      PoseEstimate pose;
      pose.x_m = 6.0 + 0.25 * (step % (4 * 60));
      pose.y_m = y_m;
      Detections detections;
      const int first = static_cast<int>(pose.x_m / kTree_m);
      for (int k = 0; k < 6; ++k) {
        for (const double side_m : {-0.5 * kRow_m, 0.5 * kRow_m}) {
          detections.trunks.push_back(tree_at(kTree_m * (first + k) - pose.x_m, side_m));
        }
      }
      benchmark::DoNotOptimize(mapper.update(detections, pose));
    }
    const double s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / num_steps;
    double& best = best_seconds()[n];
    if (best == 0.0 || s < best) best = s;
  }
  state.counters["us_per_scan"] = 1e6 * best_seconds()[n];
  state.counters["bytes_per_landmark"] = bytes_per_landmark;
}
BENCHMARK(drive)->Arg(1000)->Arg(1000000)->Iterations(60)->Unit(benchmark::kMillisecond);

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  const auto& best = best_seconds();
  if (best.count(1000) && best.count(1000000)) {
    std::printf("mapper update, 1e6 landmarks against 1e3: %.2fx (limit 1.5x)\n",
                best.at(1000000) / best.at(1000));
    std::printf("bytes per landmark at 1e6: %.0f (limit 160)\n", bytes_per_landmark);
    char measured[32];
    const double ratio = best.at(1000000) / best.at(1000);
    std::snprintf(measured, sizeof measured, "%.2fx", ratio);
    orchard::bench::print_result("mapper update along a path, 1e6 landmarks against 1e3", measured,
                                 "<= 1.5x", ratio <= 1.5);
    std::snprintf(measured, sizeof measured, "%.0f bytes", bytes_per_landmark);
    orchard::bench::print_result("memory of a landmark, observations not counted", measured,
                                 "<= 160 bytes", bytes_per_landmark <= 160.0);
  }
  return 0;
}

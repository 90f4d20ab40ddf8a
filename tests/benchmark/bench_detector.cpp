// SPDX-License-Identifier: BSD-3-Clause
// From a JPEG message to detections, five trunks in view at 320 x 240, against what a detector pays
// that decodes and filters the whole picture: cv::imdecode, HSV, grey, median, Canny.
// Both are measured in turn in one run, and the ratio is that of their medians.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "benchmark/result_line.hpp"
#include "detection/detect.hpp"
#include "detection/trunk_view.hpp"
#include "geometry/statistics.hpp"
#include "unit/detection/tube_rig.hpp"
#include "vision/appearance.hpp"
#include "vision/decode.hpp"

namespace {

using namespace orchard;

constexpr double kLimit = 0.35;

struct Situation {
  detection::Rig rig = test::tube_rig();
  laser::Scan scan;
  vision::Image jpeg;
};

/// Five tubes at 1.0 to 2.2 m before a textured room, with sensor noise and a JPEG of 8-16 kB.
const Situation& situation() {
  static const Situation kSituation = [] {
    Situation s;
    const std::vector<test::Tube> tubes{test::brown_tube(1.0, 0.45), test::brown_tube(1.5, 0.35),
                                        test::brown_tube(2.2, 0.0), test::brown_tube(1.4, -0.3),
                                        test::brown_tube(1.1, -0.55)};
    s.scan = test::scan_of(tubes);
    s.jpeg = test::picture_of_tubes(tubes, s.rig);
    cv::Mat picture(s.jpeg.height_px, s.jpeg.width_px, CV_8UC3, s.jpeg.data.data());
    cv::RNG random(7);
    cv::Mat room(picture.size(), CV_8UC3), noise(picture.size(), CV_8UC3);
    random.fill(room, cv::RNG::UNIFORM, 0, 60);
    cv::GaussianBlur(room, room, {0, 0}, 3.0);
    random.fill(noise, cv::RNG::NORMAL, 10, 2.5);
    picture -= room;
    cv::GaussianBlur(picture, picture, {0, 0}, 0.6);
    picture -= noise;
    std::vector<std::uint8_t> bytes;
    cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, 88});
    s.jpeg.encoding = vision::Encoding::kJpeg;
    s.jpeg.data = bytes;
    return s;
  }();
  return kSituation;
}

void jpeg_to_detections(benchmark::State& state) {
  const Situation& s = situation();
  for (auto _ : state) benchmark::DoNotOptimize(detection::detect(s.scan, &s.jpeg, s.rig));
}
BENCHMARK(jpeg_to_detections)->Unit(benchmark::kMicrosecond);

/// The rig with a learnt model that lets every window pass, so that edges are looked at as well.
const detection::Rig& appearance_rig() {
  static const detection::Rig kRig = [] {
    detection::Rig rig = situation().rig;
    rig.detector.colour_model = detection::ColourModel::kAppearance;
    rig.detector.appearance.bias = 5.0;
    rig.detector.appearance.mean.assign(vision::kNumAppearanceFeatures, 0.0);
    rig.detector.appearance.scale.assign(vision::kNumAppearanceFeatures, 1.0);
    rig.detector.appearance.weights.assign(vision::kNumAppearanceFeatures, 0.01);
    return rig;
  }();
  return kRig;
}

void jpeg_to_detections_by_appearance(benchmark::State& state) {
  const Situation& s = situation();
  for (auto _ : state)
    benchmark::DoNotOptimize(detection::detect(s.scan, &s.jpeg, appearance_rig()));
}
BENCHMARK(jpeg_to_detections_by_appearance)->Unit(benchmark::kMicrosecond);

/// One window, as wide in pixels as the argument.
void appearance_of_a_window(benchmark::State& state) {
  const vision::PixelRect picture = detection::picture_of(situation().rig);
  const auto pixels = vision::decode(situation().jpeg, picture);
  const auto width_px = static_cast<int>(state.range(0));
  const vision::PixelRect window{picture.width_px / 2, 20, width_px, 2 * width_px};
  for (auto _ : state) benchmark::DoNotOptimize(vision::appearance_features(*pixels, window));
}
BENCHMARK(appearance_of_a_window)->Arg(6)->Arg(12)->Arg(24)->Arg(48);

void whole_frame_once(const Situation& s) {
  const cv::Mat picture = cv::imdecode(s.jpeg.data, cv::IMREAD_COLOR);
  cv::Mat hsv, grey, edges;
  cv::cvtColor(picture, hsv, cv::COLOR_BGR2HSV);
  cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
  cv::medianBlur(grey, grey, vision::EdgeConfig::kMedianSize_px);
  cv::Canny(grey, edges, s.rig.detector.edges.canny_low, s.rig.detector.edges.canny_high);
  benchmark::DoNotOptimize(hsv.data);
  benchmark::DoNotOptimize(edges.data);
}

void whole_frame(benchmark::State& state) {
  for (auto _ : state) whole_frame_once(situation());
}
BENCHMARK(whole_frame)->Unit(benchmark::kMicrosecond);

template <class Work>
double time_us(const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  const auto end = std::chrono::steady_clock::now();
  return std::chrono::duration<double, std::micro>(end - begin).count();
}

void print_ratio(const detection::Rig& rig, const char* name) {
  const Situation& s = situation();
  std::vector<double> ours, baseline;
  for (int i = 0; i < 600; ++i) {
    baseline.push_back(time_us([&s] { whole_frame_once(s); }));
    ours.push_back(
        time_us([&] { benchmark::DoNotOptimize(detection::detect(s.scan, &s.jpeg, rig)); }));
  }
  const double ratio = geometry::median(ours) / geometry::median(baseline);
  std::printf(
      "%s: JPEG of %zu bytes to detections %.0f us, whole frame by OpenCV %.0f us: "
      "%.2fx (limit %.2fx)\n",
      name, s.jpeg.data.size(), geometry::median(ours), geometry::median(baseline), ratio, kLimit);
  char measured[32];
  std::snprintf(measured, sizeof measured, "%.2fx", ratio);
  const std::string row =
      std::string(name) + ", JPEG to detections, against the whole frame by OpenCV";
  bench::print_result(row.c_str(), measured, "<= 0.35x", ratio <= kLimit);
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const auto found = detection::detect(situation().scan, &situation().jpeg, situation().rig);
  const auto trees = std::count_if(
      found.detections.trunks.begin(), found.detections.trunks.end(),
      [](const detection::Detection& d) { return d.label == detection::Label::kTree; });
  std::printf("%ld trees in view\n", static_cast<long>(trees));
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  print_ratio(situation().rig, "detector");
  print_ratio(appearance_rig(), "detector with a learnt appearance");
  return trees == 5 ? 0 : 1;
}

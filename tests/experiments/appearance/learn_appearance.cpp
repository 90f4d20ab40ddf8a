// SPDX-License-Identifier: BSD-3-Clause
// learn_appearance LOG... --observations CSV... --config IN --out OUT: learns the appearance of
// trunks from simulated drives with their true observations and writes the model into a rig's YAML.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include "bus/node/node.hpp"
#include "bus/process/process.hpp"
#include "bus/replay/in_process_replay.hpp"
#include "calibration/trunks/appearance_learner.hpp"
#include "cli/calibrate/calibration_run.hpp"
#include "detection/detect.hpp"
#include "detection/scan_image_pairer.hpp"
#include "detection/trunk_view.hpp"
#include "io/config/config.hpp"
#include "io/config/config_edit.hpp"
#include "io/file_error.hpp"
#include "io/progress_bar.hpp"
#include "text/number_text.hpp"
#include "vision/appearance.hpp"
#include "vision/appearance_config.hpp"
#include "vision/decode.hpp"
#include "worlds/observation_csv.hpp"
#include "worlds/observation_pair.hpp"

namespace orchard {
namespace {

/// Appearance features of a window, with its scan and detection.
struct SeenWindow {
  std::int64_t utime = 0;  ///< of the scan
  std::size_t index = 0;   ///< of the detection in its message
  vision::AppearanceFeatures features{};
};

/// A node that collects the windows of all trunk candidates of the laser in every `stride`-th scan;
/// sends nothing.
class AppearanceCollector : public bus::Node {
 public:
  AppearanceCollector(const io::Config& config, int stride)
      : rig_(config.laser, config.camera, config.detector),
        pairer_(config.detector.pairing_tolerance_s, config.detector.image_wait_s,
                config.detector.use_odometry, config.camera.delay_s),
        stride_(stride) {}

  std::string_view name() const override { return "calibration"; }
  std::vector<bus::Channel> inputs() const override {
    if (!rig_.detector.use_odometry) return {bus::Channel::kScan, bus::Channel::kImage};
    return {bus::Channel::kScan, bus::Channel::kImage, bus::Channel::kOdometry};
  }
  void handle(const bus::Message& input, const bus::Outbox&) override {
    if (const auto* scan = std::get_if<laser::Scan>(&input)) {
      for (const auto& pair : pairer_.add(*scan)) observe(pair);
    } else if (const auto* image = std::get_if<vision::Image>(&input)) {
      for (const auto& pair : pairer_.add(*image)) observe(pair);
    } else if (const auto* odometry = std::get_if<pose::Odometry>(&input)) {
      const detection::Motion motion{odometry->utime, odometry->speed_mps,
                                     odometry->yaw_rate_radps};
      for (const auto& pair : pairer_.add(motion)) observe(pair);
    }
  }
  void flush(const bus::Outbox&) override {
    for (const auto& pair : pairer_.flush()) observe(pair);
  }

  const std::vector<detection::Detections>& messages() const { return messages_; }
  const std::vector<SeenWindow>& windows() const { return windows_; }

 private:
  void observe(const detection::ScanImagePair& pair) {
    if (!pair.image || num_pairs_++ % stride_ != 0) return;
    detection::LaserFindings findings = detection::find_by_laser(pair.scan, rig_);
    findings.detections.image_utime = pair.image->utime;
    auto pixels = vision::decode(*pair.image, detection::picture_of(rig_));
    if (!pixels) return;
    const auto to_exposure = detection::to_picture(findings, *pair.image, rig_, pair.motion);
    for (const vision::PixelBlock& exposed : vision::learnt_exposures(std::move(*pixels))) {
      for (const detection::Candidate& candidate : findings.candidates) {
        const auto view = detection::view_of(candidate.segment, rig_, to_exposure);
        if (!view) continue;
        windows_.push_back(
            {findings.detections.utime, candidate.index,
             vision::appearance_features(exposed, detection::trunk_window(*view, rig_))});
      }
    }
    messages_.push_back(std::move(findings.detections));
  }

  detection::Rig rig_;
  detection::ScanImagePairer pairer_;
  int stride_;
  int num_pairs_ = 0;
  std::vector<detection::Detections> messages_;
  std::vector<SeenWindow> windows_;
};

struct Options {
  std::vector<std::string> log_paths;          ///< drives with scans and pictures
  std::vector<std::string> observation_paths;  ///< truth of each log's scans, in the same order
  std::string config_path;
  std::string out_path;  ///< empty or config_path: that file; the old one is kept as .bak
  int stride = 5;        ///< uses every stride-th scan: consecutive scans are similar
  bool quiet = false;
};

using calibration::AppearanceSample;

/// Above the number of objects in a drive: separates the groups of two drives.
constexpr int kThingsMax = 100000;

void add_samples(const Options& options, const io::Config& config, std::size_t i,
                 std::vector<AppearanceSample>& samples) {
  AppearanceCollector collector(config, options.stride);
  io::ProgressBar bar("reading logs", !options.quiet);
  bus::ReplayOptions replay;
  replay.progress = [&](std::uint64_t done, std::uint64_t total) { bar.update(done, total); };
  bus::replay_in_process(options.log_paths[i], {&collector}, replay);
  bar.finish();
  const auto truth = io::read_observation_csv(options.observation_paths[i]);
  const auto found =
      evaluation::pair_observations(collector.messages(), truth, static_cast<int>(i));
  if (found.num_scans == 0) {
    throw io::FileError(
        options.observation_paths[i] + " has no scan with a picture in common with " +
        options.log_paths[i] +
        ": no time stamp is equal; give the file that was written together with this log");
  }
  std::map<std::pair<std::int64_t, std::size_t>, const evaluation::ObservationPair*> observations;
  for (const evaluation::ObservationPair& observation : found.pairs) {
    if (observation.detection)
      observations[{observation.scan_utime, observation.detection_index}] = &observation;
  }
  for (const SeenWindow& window : collector.windows()) {
    const auto at = observations.find({window.utime, window.index});
    if (at == observations.end()) continue;
    const evaluation::ObservationPair& observation = *at->second;
    const int thing = observation.truth ? observation.truth->object + 1 : 0;
    samples.push_back(
        {window.features, observation.is_tree(), static_cast<int>(i) * kThingsMax + thing});
  }
}

int learn(const Options& options) {
  const io::Config config = io::load_config(options.config_path);
  if (!config.camera.enabled) {
    throw io::FileError(
        options.config_path +
        " has camera.enabled: false; set it to true to learn the appearance of trunks");
  }
  if (options.observation_paths.size() != options.log_paths.size()) {
    throw io::FileError("there are " + std::to_string(options.log_paths.size()) + " logs and " +
                        std::to_string(options.observation_paths.size()) +
                        " observation files; give one --observations per log, in order");
  }
  std::vector<AppearanceSample> samples;
  for (std::size_t i = 0; i < options.log_paths.size(); ++i) {
    add_samples(options, config, i, samples);
  }
  calibration::AppearanceFit fit;
  try {
    fit = calibration::learn_appearance(samples);
  } catch (const std::runtime_error& error) {
    throw io::FileError(options.log_paths.front() + ": " + error.what());
  }
  fit.config.confidence_min = config.detector.appearance.confidence_min;
  const std::string note = std::to_string(fit.num_trunk) + " windows on trunks, " +
                           std::to_string(fit.num_other) + " on other objects, " +
                           std::to_string(fit.num_groups) + " of them, in " +
                           std::to_string(options.log_paths.size()) + " drives from " +
                           std::filesystem::path(options.log_paths.front()).filename().string() +
                           "; cross-validated area under the ROC curve " + fixed_text(fit.area, 4);
  const std::string out = options.out_path.empty() ? options.config_path : options.out_path;
  io::edit_config_file(options.config_path, out, cli::appearance_values(fit.config),
                       "learn_appearance", note);
  if (!options.quiet) std::printf("%s\nwritten to %s\n", note.c_str(), out.c_str());
  return bus::kExitOk;
}

}  // namespace

}  // namespace orchard

int main(int argc, char** argv) {
  orchard::Options o;
  CLI::App app{"Learns the appearance of trunks from simulated drives.", "learn_appearance"};
  app.add_option("logs", o.log_paths, "logs of drives, with scans and pictures")->required();
  app.add_option("--observations", o.observation_paths,
                 "true observations (true_observations), one file per log")
      ->required();
  app.add_option("--config", o.config_path, "rig of the recordings")->required();
  app.add_option("--out", o.out_path, "YAML to write [the rig, the old one kept as .bak]");
  app.add_option("--stride", o.stride, "use only every Nth scan")->check(CLI::Range(1, 1000));
  app.add_flag("--quiet", o.quiet, "print only warnings and errors");
  CLI11_PARSE(app, argc, argv);
  try {
    return orchard::learn(o);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "learn_appearance: %s\n", error.what());
    return orchard::bus::kExitInput;
  }
}

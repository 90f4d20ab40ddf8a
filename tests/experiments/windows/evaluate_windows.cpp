// SPDX-License-Identifier: BSD-3-Clause
// evaluate_windows --images DIR --masks DIR: learns an appearance model of trunks from pictures
// with masks (--out RIG), or tells how well a learnt one knows trunks from background (--model
// RIG).
#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "bus/process/process.hpp"
#include "calibration/trunks/appearance_learner.hpp"
#include "calibration/trunks/trunk_model.hpp"
#include "cli/calibrate/calibration_run.hpp"
#include "experiments/windows/masked_pictures.hpp"
#include "experiments/windows/window_evaluation.hpp"
#include "io/config/config.hpp"
#include "io/config/config_edit.hpp"
#include "io/file_error.hpp"
#include "text/number_text.hpp"
#include "vision/appearance.hpp"
#include "vision/colour.hpp"

namespace orchard {
namespace {

struct Options {
  std::string picture_folder, mask_folder, only;
  std::string model_path;             ///< configuration with a learnt detector.appearance
  std::string config_path, out_path;  ///< to learn one
  double exposure_ev = 0.0;
};

int learn(const Options& options, const std::vector<evaluation::PictureWindows>& pictures) {
  std::vector<calibration::AppearanceSample> samples;
  vision::HueHistogram hues;  // of the windows on trunks
  for (const evaluation::PictureWindows& picture : pictures) {
    for (const vision::PixelBlock& pixels : vision::learnt_exposures(picture.pixels)) {
      for (const evaluation::LabelledWindow& labelled : picture.windows) {
        samples.push_back({vision::appearance_features(pixels, labelled.window), labelled.is_trunk,
                           picture.group});
      }
    }
    for (const evaluation::LabelledWindow& labelled : picture.windows) {
      if (!labelled.is_trunk) continue;
      calibration::add(vision::hue_histogram(picture.pixels, labelled.window), hues);
    }
  }
  calibration::AppearanceFit fit = calibration::learn_appearance(samples);
  if (!options.config_path.empty()) {
    const io::Config config = io::load_config(options.config_path);
    fit.config.confidence_min = config.detector.appearance.confidence_min;
  }
  std::vector<io::ConfigValue> values = cli::appearance_values(fit.config);
  const auto interval = calibration::hue_interval(hues, 0.02, 2.0);  // as of trunks from a drive
  values.push_back({"detector.colour.hue_min_deg", fixed_text(interval.min_deg, 1)});
  values.push_back({"detector.colour.hue_max_deg", fixed_text(interval.max_deg, 1)});
  cli::write_rig(options.config_path, options.out_path, values, "evaluate_windows",
                 std::to_string(pictures.size()) + " pictures with masks", true);
  return bus::kExitOk;
}

int evaluate(const Options& options, const std::vector<evaluation::PictureWindows>& pictures) {
  const detection::DetectorConfig model = io::load_config(options.model_path).detector;
  const vision::ColourConfig paper;  // the defaults are the paper's
  std::vector<evaluation::ScoredWindow> scored;
  for (const evaluation::PictureWindows& picture : pictures) {
    const vision::PixelBlock pixels = evaluation::exposed(picture.pixels, options.exposure_ev);
    vision::PixelBlock judged = pixels;
    vision::normalise_exposure(judged);  // as the detector judges it
    for (const evaluation::LabelledWindow& labelled : picture.windows) {
      const auto features = vision::appearance_features(judged, labelled.window);
      const double log_odds = vision::appearance_log_odds(features, model.appearance);
      const auto hues = vision::hue_histogram(pixels, labelled.window);
      scored.push_back({picture.group, labelled.is_trunk, log_odds,
                        vision::colour_confidence(hues, model.colour).roc,
                        vision::colour_confidence(hues, paper).roc});
    }
  }
  evaluation::WindowEvaluation result =
      evaluation::evaluate_windows(scored, model.appearance.confidence_min);
  result.num_pictures = static_cast<int>(pictures.size());
  std::fputs(window_json(result).c_str(), stdout);
  return bus::kExitOk;
}

}  // namespace
}  // namespace orchard

int main(int argc, char** argv) {
  orchard::Options o;
  CLI::App app{"Learns an appearance of trunks from pictures with masks, or judges a learnt one.",
               "evaluate_windows"};
  app.add_option("--images", o.picture_folder, "folder of the pictures")->required();
  app.add_option("--masks", o.mask_folder, "their masks, of the same names and trunks in red")
      ->required();
  app.add_option("--only", o.only, "numbers of the pictures to use, such as 020-118");
  auto* out = app.add_option("--out", o.out_path, "learn, and write this rig");
  app.add_option("--config", o.config_path, "rig to write the model into")->needs(out);
  app.add_option("--model", o.model_path, "rig with a learnt appearance, to judge")->excludes(out);
  app.add_option("--exposure", o.exposure_ev, "first brighten the pictures by this much [EV]");
  CLI11_PARSE(app, argc, argv);
  try {
    const auto pictures =
        orchard::evaluation::read_masked_pictures(o.picture_folder, o.mask_folder, o.only);
    return o.out_path.empty() ? orchard::evaluate(o, pictures) : orchard::learn(o, pictures);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "evaluate_windows: %s\n", error.what());
    return orchard::bus::kExitInput;
  }
}

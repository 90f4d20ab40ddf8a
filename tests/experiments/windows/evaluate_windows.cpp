// SPDX-License-Identifier: BSD-3-Clause
// evaluate_windows --images DIR --masks DIR --model MODEL: how well a learnt appearance model tells
// trunks from background in pictures with masks.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "bus/process/process.hpp"
#include "cli/evaluate/mask_windows_reader.hpp"
#include "experiments/windows/window_evaluation.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"
#include "vision/appearance.hpp"
#include "vision/colour.hpp"

namespace orchard {
namespace {

struct Options {
  cli::MaskedPictureOptions pictures;
  std::string model_path;  ///< configuration with a learnt detector.appearance
  evaluation::Disturbance disturbance;
};

int evaluate(const Options& options) {
  const detection::DetectorConfig model = io::load_config(options.model_path).detector;
  if (!model.appearance.learnt()) {
    throw io::FileError(options.model_path +
                        ": has no learnt detector.appearance; learn one with `orchard calibrate "
                        "trunks --images DIR --masks DIR --out MODEL`");
  }
  const vision::ColourConfig paper;  // the defaults are the paper's
  std::vector<evaluation::ScoredWindow> scored;
  const cli::PictureCount count = cli::for_each_masked_picture(
      options.pictures, "evaluate_windows", false, [&](const cli::PictureWindows& picture) {
        const vision::PixelBlock pixels =
            evaluation::disturbed(picture.picture.pixels, options.disturbance);
        vision::PixelBlock judged = pixels;
        vision::normalise_exposure(judged);  // as the detector judges it
        for (const calibration::LabelledWindow& labelled : picture.windows) {
          const auto features = vision::appearance_features(judged, labelled.window);
          const double log_odds = vision::appearance_log_odds(features, model.appearance);
          const auto hues = vision::hue_histogram(pixels, labelled.window);
          scored.push_back({picture.group, labelled.is_trunk, log_odds,
                            vision::colour_confidence(hues, model.colour).roc,
                            vision::colour_confidence(hues, paper).roc});
        }
      });
  evaluation::WindowEvaluation result =
      evaluation::evaluate_windows(scored, model.appearance.confidence_min);
  result.num_pictures = count.used;
  result.left_out = count.left_out;
  std::fputs(window_json(result).c_str(), stdout);
  return bus::kExitOk;
}

/// Adds an option that must lie in a range; its help names the default.
template <class Value>
void add_limit(CLI::App& app, const char* name, Value& value, Value lo, Value hi,
               const char* what) {
  app.add_option(name, value, what)->check(CLI::Range(lo, hi))->capture_default_str();
}

}  // namespace
}  // namespace orchard

int main(int argc, char** argv) {
  orchard::Options o;
  orchard::cli::MaskedPictureOptions& pictures = o.pictures;
  orchard::calibration::MaskWindowOptions& windows = pictures.windows;
  CLI::App app{"Measures how well a learnt appearance model tells trunks from background.",
               "evaluate_windows"};
  app.add_option("--images", pictures.picture_folder, "folder of the pictures")->required();
  app.add_option("--masks", pictures.mask_folder,
                 "masks of the pictures, with the same names and trunks in red")
      ->required();
  app.add_option("--model", o.model_path, "configuration with a learnt detector.appearance")
      ->required();
  app.add_option("--only", pictures.only, "numbers of the pictures to use, such as 020-118");
  using orchard::add_limit;
  add_limit(app, "--per-picture", windows.per_class, 1, 10000,
            "windows of each kind (on and off trunks) per picture");
  add_limit(app, "--aspect-min", windows.aspect_min, 0.1, 20.0,
            "min ratio of height to width of a window");
  add_limit(app, "--aspect-max", windows.aspect_max, 0.1, 20.0,
            "max ratio of height to width of a window");
  add_limit(app, "--width-scale", windows.width_scale, 0.1, 10.0,
            "width of a window in trunk widths");
  add_limit(app, "--scatter", windows.scatter, 0.0, 0.9,
            "max random offset of a window, as a fraction of its width");
  app.add_option("--seed", windows.seed, "seed of the positions of the windows");
  add_limit(app, "--exposure", o.disturbance.exposure_ev, -8.0, 8.0,
            "first brighten the pictures by this much [EV]");
  add_limit(app, "--red-gain", o.disturbance.red_gain, 0.1, 10.0,
            "first multiply red by this factor (a wrong white balance)");
  add_limit(app, "--blue-gain", o.disturbance.blue_gain, 0.1, 10.0,
            "first multiply blue by this factor");
  add_limit(app, "--blur", o.disturbance.blur_px, 0.0, 100.0,
            "first blur the pictures by this sigma [px]");
  CLI11_PARSE(app, argc, argv);
  try {
    return orchard::evaluate(o);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "evaluate_windows: %s\n", error.what());
    return orchard::bus::kExitInput;
  }
}

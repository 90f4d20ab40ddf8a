// SPDX-License-Identifier: BSD-3-Clause
#include "cli/evaluate/evaluate_windows.hpp"

#include <cstdio>
#include <vector>

#include "bus/process/process.hpp"
#include "cli/evaluate/worst_windows.hpp"
#include "evaluation/window_evaluation.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"
#include "vision/appearance/appearance.hpp"
#include "vision/appearance/exposure.hpp"
#include "vision/colour.hpp"

namespace orchard::cli {

int run_evaluate_windows(const EvaluateWindowsOptions& options) {
  const detection::DetectorConfig model = io::load_config(options.model_path).detector;
  if (!model.appearance.learnt()) {
    throw io::FileError(options.model_path +
                        ": has no learnt detector.appearance; learn one with `orchard calibrate "
                        "trunks --images DIR --masks DIR --out MODEL`");
  }
  const vision::ColourConfig paper;  // the defaults are the paper's
  std::vector<evaluation::ScoredWindow> scored;
  WorstWindows worst;
  const PictureCount count = for_each_masked_picture(
      options.pictures, "orchard evaluate", [&](const PictureWindows& picture) {
        const vision::PixelBlock pixels =
            evaluation::disturbed(picture.picture.pixels, options.disturbance);
        vision::PixelBlock judged = pixels;
        vision::normalise_exposure(judged);  // as the detector judges it
        for (const calibration::LabelledWindow& labelled : picture.windows) {
          const auto features = vision::appearance_features(judged, labelled.window);
          const double log_odds = vision::appearance_log_odds(features, model.appearance);
          const auto hues = vision::hue_histogram(pixels, labelled.window, model.colour);
          const auto paper_hues = vision::hue_histogram(pixels, labelled.window, paper);
          scored.push_back({picture.group, labelled.is_trunk, log_odds,
                            vision::colour_confidence(hues, model.colour).roc,
                            vision::colour_confidence(paper_hues, paper).roc});
          if (!options.worst_path.empty()) {
            worst.add(picture.name, pixels, labelled,
                      vision::appearance_confidence(features, model.appearance));
          }
        }
      });
  evaluation::WindowEvaluation result =
      evaluation::evaluate_windows(scored, model.appearance.confidence_min);
  result.num_pictures = count.used;
  result.left_out = count.left_out;
  if (!options.worst_path.empty()) worst.write(options.worst_path);
  std::fputs((options.json ? window_json(result) : window_summary(result)).c_str(), stdout);
  return bus::kExitOk;
}

}  // namespace orchard::cli

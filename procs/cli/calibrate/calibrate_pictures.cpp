// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/calibrate.hpp"

#include <fmt/core.h>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "bus/process/process.hpp"
#include "calibration/trunks/appearance_learner.hpp"
#include "calibration/trunks/trunk_model.hpp"
#include "cli/calibrate/calibration_run.hpp"
#include "io/atomic_file.hpp"
#include "io/config/config.hpp"
#include "io/config/config_edit.hpp"
#include "io/file_error.hpp"
#include "text/number_text.hpp"
#include "vision/appearance.hpp"

namespace orchard::cli {
namespace {

constexpr const char* kCommand = "orchard calibrate";
constexpr double kHueTail = 0.02;  // same as for trunks from a drive
constexpr double kHueMargin_deg = 2.0;
constexpr double kUselessHues_deg = 90.0;

/// Training data from the windows of all pictures.
struct Lessons {
  std::vector<calibration::AppearanceSample> samples;
  vision::HueHistogram hues;  ///< of the windows on trunks
};

void learn_from(const PictureWindows& picture, Lessons& lessons) {
  for (const vision::PixelBlock& pixels : vision::learnt_exposures(picture.picture.pixels)) {
    for (const calibration::LabelledWindow& labelled : picture.windows) {
      lessons.samples.push_back(
          {vision::appearance_features(pixels, labelled.window), labelled.is_trunk, picture.group});
    }
  }
  for (const calibration::LabelledWindow& labelled : picture.windows) {
    if (labelled.is_trunk) {
      calibration::add(vision::hue_histogram(picture.picture.pixels, labelled.window),
                       lessons.hues);
    }
  }
}

void add_hue_interval(const vision::HueHistogram& hues, std::vector<io::ConfigValue>& values) {
  if (hues.num_coloured == 0) return;
  const auto interval = calibration::hue_interval(hues, kHueTail, kHueMargin_deg);
  values.push_back({"detector.colour.hue_min_deg", fixed_text(interval.min_deg, 1)});
  values.push_back({"detector.colour.hue_max_deg", fixed_text(interval.max_deg, 1)});
  if (interval.width_deg > kUselessHues_deg) {
    std::fprintf(stderr,
                 "%s: warning: the hues of the trunks spread over %.0f degrees, too wide for "
                 "colour_model hue_interval; the learnt appearance model does not use them\n",
                 kCommand, interval.width_deg);
  }
}

std::string note_of(const calibration::AppearanceFit& fit, const PictureCount& count,
                    const CalibrateTrunksOptions& options) {
  std::string from = std::filesystem::path(options.pictures.picture_folder).lexically_normal();
  if (!options.pictures.only.empty()) from += " " + options.pictures.only;
  return from + fmt::format(
                    ": {} pictures of {} trees, {} windows on trunks, {} elsewhere; area under the "
                    "ROC curve {:.4f} (cross-validated over trees), penalty {:g}",
                    count.used, count.num_groups, fit.num_trunk, fit.num_other, fit.area,
                    fit.penalty);
}

}  // namespace

int run_calibrate_pictures(const CalibrateTrunksOptions& options) {
  const io::Config config =
      options.config_path.empty() ? io::Config() : io::load_config(options.config_path);
  Lessons lessons;
  const PictureCount count =
      for_each_masked_picture(options.pictures, kCommand, options.quiet,
                              [&](const PictureWindows& picture) { learn_from(picture, lessons); });
  calibration::AppearanceFit fit = naming(options.pictures.picture_folder, [&] {
    return calibration::learn_appearance(lessons.samples);
  });
  fit.config.confidence_min = config.detector.appearance.confidence_min;
  if (count.num_groups < 2) {
    std::fprintf(stderr,
                 "%s: warning: all pictures show one tree, so the quality of the model on other "
                 "trees is unknown; give pictures of about twenty trees\n",
                 kCommand);
  }

  std::vector<io::ConfigValue> values = appearance_values(fit.config);
  add_hue_interval(lessons.hues, values);
  const std::string note = note_of(fit, count, options);
  if (!options.quiet) std::printf("%s\n", note.c_str());
  write_rig(options.config_path, options.out_path, values, "orchard calibrate trunks", note,
            options.quiet);
  return bus::kExitOk;
}

}  // namespace orchard::cli

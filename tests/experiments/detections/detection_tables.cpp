// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include "experiments/detections/detection_report.hpp"

namespace orchard::evaluation {
namespace {

void add_counts(std::string& text, const char* name, const Counts& c) {
  text += fmt::format("{:<22} {:9.4f} {:9.4f} {:9.4f} {:7} {:7} {:7}", name, c.precision(),
                      c.recall(), c.f1(), c.num_right, c.num_wrong, c.num_missed);
}

void add_slices(std::string& text, const char* title, const std::vector<Slice>& slices) {
  text += fmt::format("\n{:<22} {:>9} {:>9} {:>9} {:>7} {:>7} {:>7} {:>12}\n", title, "precision",
                      "recall", "F1", "right", "wrong", "missed", "centre mm");
  for (const Slice& slice : slices) {
    add_counts(text, slice.name.c_str(), slice.counts);
    if (slice.centre.num > 0) text += fmt::format(" {:12.1f}", 1e3 * slice.centre.rms_m);
    text += "\n";
  }
}

void add_reliability(std::string& text, const char* what, const Reliability& r) {
  text += fmt::format("\n{}: expected calibration error {:.4f}, Brier score {:.4f}, from {}\n",
                      what, r.expected_calibration_error, r.brier_score, r.num);
  text += fmt::format("{:<22} {:>9} {:>9} {:>9}\n", "stated", "mean", "was tree", "number");
  for (const ReliabilityBin& bin : r.bins) {
    if (bin.num == 0) continue;
    text += fmt::format("{:.1f} to {:.1f} {:22.4f} {:9.4f} {:9}\n", bin.from, bin.to,
                        bin.mean_probability, bin.frequency, bin.num);
  }
}

}  // namespace

std::string detection_tables(const DetectionEvaluation& e) {
  std::string text;
  const DetectionRules& rules = e.rules;
  text += fmt::format(
      "Evaluated: objects nearer than {:.1f} m, with at least {} beams and at most {:.0f} % "
      "occluded{}\n"
      "\n",
      rules.range_max_m, rules.num_beams_min, 100.0 * rules.hidden_max,
      rules.in_picture ? ", entirely in the picture" : "");
  text += fmt::format("{:<22} {:>9} {:>9} {:>9} {:>7} {:>7} {:>7}\n", "class tree", "precision",
                      "recall", "F1", "right", "wrong", "missed");
  add_counts(text, "per observation", e.counts);
  text += "\n";
  if (e.landmarks) {
    add_counts(text, "per landmark", e.landmarks->counts);
    text += "\n";
  }
  text += fmt::format(
      "false positives: {} on another object, {} on no object; missed: {} not detected, {} "
      "UNSEEN\n",
      e.counts.num_wrong_on_object, e.counts.num_wrong - e.counts.num_wrong_on_object,
      e.counts.num_not_detected, e.counts.num_unseen);
  add_slices(text, "by range", e.by_range);
  if (e.by_recording.size() > 1) add_slices(text, "by recording", e.by_recording);

  text += fmt::format("\n{:<22} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "one score alone",
                      "of trees", "of others", "area", "threshold", "precision", "recall", "F1");
  for (const ScoreTest& test : e.tests) {
    text +=
        fmt::format("{:<22} {:9.4f} {:9.4f} {:9.4f} {:9.4f} {:9.4f} {:9.4f} {:9.4f}\n", test.name,
                    test.mean_of_trees, test.mean_of_others, test.area, test.best_threshold,
                    test.best.precision(), test.best.recall(), test.best.f1());
  }
  text +=
      "(of trees, of others: mean rate of confidence; threshold: the best one for these "
      "observations)\n";
  if (e.has_probability) {
    add_reliability(text, "probability per observation", e.reliability);
  } else {
    text +=
        "\n"
        "the messages have no probabilities (detector.probability.enabled is false)\n";
  }
  if (e.landmarks) add_reliability(text, "probability per landmark", e.landmarks->reliability);
  return text;
}

}  // namespace orchard::evaluation

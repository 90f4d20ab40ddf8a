// SPDX-License-Identifier: BSD-3-Clause
#include <cstdarg>
#include <cstdio>

#include "evaluation/detection_report.hpp"

namespace orchard::evaluation {
namespace {

class Text {
 public:
  [[gnu::format(printf, 2, 3)]] void add(const char* format, ...) {
    char line[300];
    va_list values;
    va_start(values, format);
    std::vsnprintf(line, sizeof line, format, values);
    va_end(values);
    text_ += line;
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

void add_counts(Text& text, const char* name, const Counts& c) {
  text.add("%-22s %9.4f %9.4f %9.4f %7d %7d %7d", name, c.precision(), c.recall(), c.f1(),
           c.num_right, c.num_wrong, c.num_missed);
}

void add_slices(Text& text, const char* title, const std::vector<Slice>& slices) {
  text.add("\n%-22s %9s %9s %9s %7s %7s %7s %12s\n", title, "precision", "recall", "F1", "right",
           "wrong", "missed", "centre mm");
  for (const Slice& slice : slices) {
    add_counts(text, slice.name.c_str(), slice.counts);
    if (slice.centre.num > 0) text.add(" %12.1f", 1e3 * slice.centre.rms_m);
    text.add("\n");
  }
}

void add_reliability(Text& text, const char* what, const Reliability& r) {
  text.add("\n%s: expected calibration error %.4f, Brier score %.4f, from %d\n", what,
           r.expected_calibration_error, r.brier_score, r.num);
  text.add("%-22s %9s %9s %9s\n", "stated", "mean", "was tree", "number");
  for (const ReliabilityBin& bin : r.bins) {
    if (bin.num == 0) continue;
    text.add("%.1f to %.1f %22.4f %9.4f %9d\n", bin.from, bin.to, bin.mean_probability,
             bin.frequency, bin.num);
  }
}

}  // namespace

std::string detection_tables(const DetectionEvaluation& e) {
  Text text;
  const DetectionRules& rules = e.rules;
  text.add("Counted: things nearer than %.1f m, at least %d beams, at most %.0f %% hidden%s\n\n",
           rules.range_max_m, rules.num_beams_min, 100.0 * rules.hidden_max,
           rules.in_picture ? ", whole in the picture" : "");
  text.add("%-22s %9s %9s %9s %7s %7s %7s\n", "class tree", "precision", "recall", "F1", "right",
           "wrong", "missed");
  add_counts(text, "per observation", e.counts);
  text.add("\n");
  if (e.landmarks) {
    add_counts(text, "per landmark", e.landmarks->counts);
    text.add("\n");
  }
  text.add("wrong: %d on another thing, %d on nothing; missed: %d not detected, %d UNSEEN\n",
           e.counts.num_wrong_on_object, e.counts.num_wrong - e.counts.num_wrong_on_object,
           e.counts.num_not_detected, e.counts.num_unseen);
  add_slices(text, "by range", e.by_range);
  if (e.by_recording.size() > 1) add_slices(text, "by recording", e.by_recording);

  text.add("\n%-22s %9s %9s %9s %9s %9s %9s %9s\n", "one score alone", "of trees", "of others",
           "area", "threshold", "precision", "recall", "F1");
  for (const ScoreTest& test : e.tests) {
    text.add("%-22s %9.4f %9.4f %9.4f %9.4f %9.4f %9.4f %9.4f\n", test.name.c_str(),
             test.mean_of_trees, test.mean_of_others, test.area, test.best_threshold,
             test.best.precision(), test.best.recall(), test.best.f1());
  }
  text.add("(of trees, of others: mean rate of confidence; threshold: the best on these looks)\n");
  if (e.has_probability) {
    add_reliability(text, "probability per observation", e.reliability);
  } else {
    text.add("\nno probabilities in these messages (detector.probability.enabled)\n");
  }
  if (e.landmarks) add_reliability(text, "probability per landmark", e.landmarks->reliability);
  return text.take();
}

}  // namespace orchard::evaluation

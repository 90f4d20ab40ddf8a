// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "evaluation/detections/detection_report.hpp"

namespace orchard::evaluation {
namespace {

Plot curves(const DetectionEvaluation& e) {
  Plot plot{"Precision and recall, one score alone", "recall", "precision", 0, 1, 0, 1, {}};
  for (const ScoreTest& test : e.tests) {
    plot.series.push_back({test.name, test.curve, true, false, false});
  }
  return plot;
}

PlotSeries diagonal() { return {"", {{0, 0}, {1, 1}}, true, false, true}; }

PlotSeries bins(const std::string& name, const Reliability& r) {
  PlotSeries series{name, {}, true, true, false};
  for (const ReliabilityBin& bin : r.bins) {
    if (bin.num > 0) series.points.push_back({bin.mean_probability, bin.frequency});
  }
  return series;
}

Plot diagram(const DetectionEvaluation& e) {
  Plot plot{"Reliability of the probabilities",
            "stated probability of a tree",
            "fraction of trees",
            0,
            1,
            0,
            1,
            {diagonal()}};
  if (e.has_probability) plot.series.push_back(bins("per observation", e.reliability));
  if (e.landmarks) plot.series.push_back(bins("per landmark", e.landmarks->reliability));
  return plot;
}

double far_end_m(const DetectionEvaluation& e) {
  return e.by_range.empty() ? 1.0 : e.by_range.back().to_m;
}

Plot scores_by_range(const DetectionEvaluation& e) {
  PlotSeries f1{"F1", {}, true, true, false}, precision{"precision", {}, true, true, false},
      recall{"recall", {}, true, true, false};
  for (const Slice& slice : e.by_range) {
    const double middle_m = 0.5 * (slice.from_m + slice.to_m);
    f1.points.push_back({middle_m, slice.counts.f1()});
    precision.points.push_back({middle_m, slice.counts.precision()});
    recall.points.push_back({middle_m, slice.counts.recall()});
  }
  return {"Class tree by range", "range (m)", "fraction", 0,
          far_end_m(e),          0,           1,          {f1, precision, recall}};
}

Plot errors_by_range(const DetectionEvaluation& e) {
  PlotSeries rms{"RMS", {}, true, true, false};
  double most_mm = 10.0;
  for (const Slice& slice : e.by_range) {
    if (slice.centre.num == 0) continue;
    rms.points.push_back({0.5 * (slice.from_m + slice.to_m), 1e3 * slice.centre.rms_m});
    most_mm = std::max(most_mm, 1.1e3 * slice.centre.rms_m);
  }
  return {
      "Centre of trees by range", "range (m)", "error (mm)", 0, far_end_m(e), 0, most_mm, {rms}};
}

}  // namespace

std::vector<Plot> detection_plots(const DetectionEvaluation& e) {
  std::vector<Plot> plots{curves(e)};
  if (e.has_probability || e.landmarks) plots.push_back(diagram(e));
  plots.push_back(scores_by_range(e));
  plots.push_back(errors_by_range(e));
  return plots;
}

}  // namespace orchard::evaluation

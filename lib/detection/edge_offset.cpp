// SPDX-License-Identifier: BSD-3-Clause
#include "detection/edge_offset.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace orchard::detection {
namespace {

/// Min roc of a line; weaker lines are texture and background.
constexpr double kRocMin = 0.5;
/// Lines nearer to each other than this are one line found in two windows.
constexpr double kSameLine_px = 1.0;
/// Tolerance of the width in the image against the laser's: about a beam step and a pixel, plus a
/// fraction of the width.
constexpr double kWidthTolerance_px = 1.5;
constexpr double kWidthToleranceFraction = 0.15;

vision::PixelRect widened(const vision::PixelRect& window, double reach_px) {
  const int reach = static_cast<int>(std::ceil(reach_px));
  return {window.x_px - reach, window.y_px, window.width_px + 2 * reach, window.height_px};
}

/// Finds lines in windows that are shifted across the search range in steps of half a window.
std::vector<vision::EdgeLine> lines_about(const vision::EdgeMap& map,
                                          const vision::PixelRect& window, double expected_x_px,
                                          double reach_px, const Rig& rig) {
  std::vector<vision::EdgeLine> lines;
  const int step = std::max(1, window.width_px / 2);
  const int num_steps = static_cast<int>(std::ceil(reach_px / step));
  for (int i = -num_steps; i <= num_steps; ++i) {
    const vision::PixelRect slid = vision::intersection(
        {window.x_px + i * step, window.y_px, window.width_px, window.height_px}, map.area);
    if (slid.width_px < vision::WindowConfig::kMinSize_px || slid.height_px < window.height_px) {
      continue;
    }
    const auto line = vision::find_edge(map, slid, expected_x_px + i * step, rig.detector.edges);
    if (!line.found || line.roc < kRocMin) continue;
    const auto same = std::find_if(lines.begin(), lines.end(), [&](const auto& other) {
      return std::abs(other.x_px - line.x_px) < kSameLine_px;
    });
    if (same == lines.end()) {
      lines.push_back(line);
    } else if (line.roc > same->roc) {
      *same = line;
    }
  }
  return lines;
}

}  // namespace

vision::PixelRect edge_offset_area(const TrunkView& view, double reach_px, const Rig& rig) {
  const vision::PixelRect picture = picture_of(rig);
  return vision::bounding(vision::edge_reading_area(widened(view.left_edge, reach_px), picture),
                          vision::edge_reading_area(widened(view.right_edge, reach_px), picture));
}

std::vector<EdgeOffset> edge_offsets(const vision::EdgeMap& map, const TrunkView& view,
                                     double reach_px, const Rig& rig) {
  const auto left = lines_about(map, view.left_edge, view.left_x_px, reach_px, rig);
  const auto right = lines_about(map, view.right_edge, view.right_x_px, reach_px, rig);
  const double width_px = view.right_x_px - view.left_x_px;
  const double tolerance_px = kWidthTolerance_px + kWidthToleranceFraction * width_px;
  std::vector<EdgeOffset> offsets;
  for (const vision::EdgeLine& l : left) {
    for (const vision::EdgeLine& r : right) {
      if (std::abs(r.x_px - l.x_px - width_px) > tolerance_px) continue;
      const EdgeOffset offset{l.x_px - view.left_x_px, r.x_px - view.right_x_px,
                              std::min(l.roc, r.roc)};
      if (std::abs(offset.middle_px()) <= reach_px) offsets.push_back(offset);
    }
  }
  std::stable_sort(offsets.begin(), offsets.end(),
                   [](const EdgeOffset& a, const EdgeOffset& b) { return a.roc > b.roc; });
  return offsets;
}

std::vector<CandidateEdges> find_candidate_edges(const LaserFindings& findings,
                                                 vision::PictureReader& picture, const Rig& rig,
                                                 const std::optional<Motion>& motion,
                                                 double reach_px) {
  const vision::Image& image = picture.image();
  std::vector<CandidateEdges> seen;
  const auto to_exposure = to_picture(findings, image, rig, motion);
  vision::PixelRect reading;
  for (std::size_t i = 0; i < findings.candidates.size(); ++i) {
    const auto view = view_of(findings.candidates[i].segment, rig, to_exposure);
    if (!view) continue;
    seen.push_back({i, *view, {}});
    reading = vision::bounding(reading, edge_offset_area(*view, reach_px, rig));
    picture.expect(reading_area(*view, rig));
  }
  const bool fits = image.width_px == rig.camera.intrinsics().width_px &&
                    image.height_px == rig.camera.intrinsics().height_px;
  if (reading.empty() || !fits) return {};
  const auto pixels = picture.read(reading);
  if (!pixels) return {};
  const vision::EdgeMap map = vision::edge_map(*pixels, rig.detector.edges);
  for (CandidateEdges& candidate : seen) {
    candidate.offsets = edge_offsets(map, candidate.view, reach_px, rig);
  }
  seen.erase(std::remove_if(seen.begin(), seen.end(),
                            [](const CandidateEdges& c) { return c.offsets.empty(); }),
             seen.end());
  return seen;
}

}  // namespace orchard::detection

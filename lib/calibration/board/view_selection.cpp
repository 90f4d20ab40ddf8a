// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/board/view_selection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

namespace orchard::calibration {
namespace {

/// Position, size and tilt of the board in a view; each number varies by about 1.
using Observation = std::array<double, 5>;

Observation observation_of(const BoardView& view, int width_px, int height_px) {
  const auto n = static_cast<double>(view.corners_px.size());
  double x_px = 0.0, y_px = 0.0;
  for (const ImagePoint& corner : view.corners_px) {
    x_px += corner.x_px / n;
    y_px += corner.y_px / n;
  }
  std::vector<cv::Point2f> board, picture;
  double extent_m = 0.0;
  for (const BoardPoint& place : view.corners_m) {
    extent_m = std::max({extent_m, std::abs(place.x_m), std::abs(place.y_m)});
  }
  for (std::size_t i = 0; i < view.corners_px.size(); ++i) {
    board.emplace_back(static_cast<float>(view.corners_m[i].x_m / extent_m),
                       static_cast<float>(view.corners_m[i].y_m / extent_m));
    picture.emplace_back(static_cast<float>(view.corners_px[i].x_px / width_px),
                         static_cast<float>(view.corners_px[i].y_px / width_px));
  }
  Observation observation{2.0 * x_px / width_px, 2.0 * y_px / height_px, 0.0, 0.0, 0.0};
  const cv::Mat H = cv::findHomography(board, picture);
  if (H.empty()) return observation;
  const double size =
      std::abs(H.at<double>(0, 0) * H.at<double>(1, 1) - H.at<double>(0, 1) * H.at<double>(1, 0));
  observation[2] = 0.5 * std::log(std::max(size, 1e-6));
  // Perspective: relative distance of the two ends of the board.
  observation[3] = 3.0 * std::clamp(H.at<double>(2, 0), -1.0, 1.0);
  observation[4] = 3.0 * std::clamp(H.at<double>(2, 1), -1.0, 1.0);
  return observation;
}

double distance2(const Observation& a, const Observation& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

}  // namespace

std::vector<std::size_t> select_spread(const std::vector<NamedView>& views, int width_px,
                                       int height_px, std::size_t count) {
  std::vector<std::size_t> selected;
  if (views.size() <= count) {
    for (std::size_t i = 0; i < views.size(); ++i) selected.push_back(i);
    return selected;
  }
  std::vector<Observation> observations;
  for (const NamedView& view : views)
    observations.push_back(observation_of(view.view, width_px, height_px));
  // Greedy: repeatedly take the view farthest from all selected ones.
  std::vector<double> nearest2(views.size(), std::numeric_limits<double>::max());
  std::size_t next = 0;
  while (selected.size() < count) {
    selected.push_back(next);
    for (std::size_t i = 0; i < views.size(); ++i) {
      nearest2[i] = std::min(nearest2[i], distance2(observations[i], observations[next]));
    }
    next = static_cast<std::size_t>(std::max_element(nearest2.begin(), nearest2.end()) -
                                    nearest2.begin());
  }
  std::sort(selected.begin(), selected.end());
  selected.erase(std::unique(selected.begin(), selected.end()), selected.end());
  return selected;
}

}  // namespace orchard::calibration

// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/album/choose_photographs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/point_grid.hpp"

namespace orchard::mapping {
namespace {

/// Max distance of a photograph's subject from its landmark's centre [m]; more for wide landmarks.
constexpr double kOfLandmark_m = 0.4;
constexpr double kSearchMax_m = 3.0;

double reach_m(const Landmark& landmark) {
  return std::min(kSearchMax_m, std::max(kOfLandmark_m, 0.5 * landmark.width_m + 0.2));
}

/// Index of the landmark nearest to a photograph's subject; none if it is too far away.
std::optional<std::size_t> landmark_of(const PlacedPhotograph& photograph,
                                       const std::vector<Landmark>& landmarks,
                                       const geometry::PointGrid& grid) {
  std::optional<std::size_t> nearest;
  double nearest_m = kSearchMax_m;
  for (const std::int32_t k : grid.near({photograph.x_m, photograph.y_m}, kSearchMax_m)) {
    const Landmark& landmark = landmarks[static_cast<std::size_t>(k)];
    const double distance_m =
        std::hypot(landmark.x_m - photograph.x_m, landmark.y_m - photograph.y_m);
    if (distance_m >= nearest_m || distance_m > reach_m(landmark)) continue;
    nearest = static_cast<std::size_t>(k);
    nearest_m = distance_m;
  }
  return nearest;
}

}  // namespace

std::vector<AlbumEntry> choose_photographs(const std::vector<Landmark>& landmarks,
                                           const std::vector<PlacedPhotograph>& photographs,
                                           std::size_t max_bytes) {
  geometry::PointGrid grid;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (!std::isfinite(landmarks[i].x_m) || !std::isfinite(landmarks[i].y_m)) continue;
    grid.insert(static_cast<std::int32_t>(i), landmarks[i].x_m, landmarks[i].y_m);
  }
  std::vector<const Photograph*> best(landmarks.size(), nullptr);
  for (const PlacedPhotograph& photograph : photographs) {
    const auto i = landmark_of(photograph, landmarks, grid);
    if (!i) continue;
    if (best[*i] == nullptr || photograph.photograph.quality > best[*i]->quality) {
      best[*i] = &photograph.photograph;
    }
  }
  struct Wanted {
    std::size_t landmark;
    bool is_tree;
  };
  std::vector<Wanted> order;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (best[i] == nullptr) continue;
    order.push_back({i, landmarks[i].label == detection::Label::kTree});
  }
  std::stable_sort(order.begin(), order.end(), [&best](const Wanted& a, const Wanted& b) {
    if (a.is_tree != b.is_tree) return a.is_tree;
    return best[a.landmark]->quality > best[b.landmark]->quality;
  });
  std::vector<AlbumEntry> entries;
  std::size_t num_bytes = 0;
  for (const Wanted& wanted : order) {
    const Photograph* photograph = best[wanted.landmark];
    if (num_bytes + photograph->jpeg.size() > max_bytes) continue;
    num_bytes += photograph->jpeg.size();
    entries.push_back({landmarks[wanted.landmark].id, photograph});
  }
  std::sort(entries.begin(), entries.end(),
            [](const AlbumEntry& a, const AlbumEntry& b) { return a.landmark_id < b.landmark_id; });
  return entries;
}

}  // namespace orchard::mapping

// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/corrections/carry_corrections.hpp"

#include <map>

#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;
using geometry::Pose2;

/// Local deformation of the new map against the rigid alignment, from landmarks known in both.
class Bend {
 public:
  Bend(const std::vector<Landmark>& earlier, const std::vector<Landmark>& now,
       const Pose2& T_earlier_now)
      : T_earlier_now_(T_earlier_now), known_(known_of(earlier, now)) {}

  Vector2d now(const Vector2d& p_earlier) const {
    constexpr std::size_t kNumNeighbours = 9;
    constexpr double kReach_m = 25.0;
    std::vector<double> x_m, y_m;
    for (const std::int32_t i : known_.nearest_few(p_earlier, kReach_m, kNumNeighbours)) {
      const Vector2d shift_m = shifts_m_[static_cast<std::size_t>(i)];
      x_m.push_back(shift_m.x());
      y_m.push_back(shift_m.y());
    }
    Vector2d p = inverse_transform(T_earlier_now_, p_earlier);
    if (!x_m.empty()) p += Vector2d(geometry::median(x_m), geometry::median(y_m));
    return p;
  }

 private:
  geometry::IndexedPoints known_of(const std::vector<Landmark>& earlier,
                                   const std::vector<Landmark>& now) {
    std::map<std::int32_t, Vector2d> places_now;
    for (const Landmark& l : now) places_now[l.id] = {l.x_m, l.y_m};
    std::vector<Vector2d> places;
    for (const Landmark& l : earlier) {
      const auto found = places_now.find(l.id);
      if (found == places_now.end()) continue;
      const Vector2d p_earlier(l.x_m, l.y_m);
      places.push_back(p_earlier);
      shifts_m_.push_back(found->second - inverse_transform(T_earlier_now_, p_earlier));
    }
    return geometry::IndexedPoints(std::move(places));
  }

  Pose2 T_earlier_now_;
  std::vector<Vector2d> shifts_m_;
  geometry::IndexedPoints known_;
};

}  // namespace

std::vector<Landmark> known_landmarks(const std::vector<Landmark>& earlier,
                                      const std::vector<Landmark>& corrected) {
  std::map<std::int32_t, bool> is_mapped;
  for (const Landmark& l : earlier) is_mapped[l.id] = true;
  std::vector<Landmark> known = earlier;
  for (const Landmark& l : corrected) {
    if (is_mapped.count(l.id) == 0) known.push_back(l);
  }
  return known;
}

std::vector<Correction> carry_corrections(const std::vector<Correction>& corrections,
                                          const std::vector<Landmark>& earlier,
                                          const std::vector<Landmark>& now,
                                          const Pose2& T_earlier_now) {
  const Bend bend(earlier, now, T_earlier_now);
  std::map<std::int32_t, const Landmark*> then, found_again;
  for (const Landmark& l : earlier) then[l.id] = &l;
  for (const Landmark& l : now) found_again[l.id] = &l;
  std::vector<Correction> carried = corrections;
  for (Correction& c : carried) {
    for (CorrectionTarget& target : c.targets) {
      constexpr double kSame_m = 0.002;  // files are rounded to 0.1 mm
      const auto before = then.find(target.id);
      const auto after = found_again.find(target.id);
      const bool is_as_mapped =
          before != then.end() && after != found_again.end() &&
          (Vector2d(before->second->x_m, before->second->y_m) - target.p_map).norm() < kSame_m;
      target.p_map =
          is_as_mapped ? Vector2d(after->second->x_m, after->second->y_m) : bend.now(target.p_map);
    }
    for (Vector2d& p : c.places_map) p = bend.now(p);
  }
  return carried;
}

}  // namespace orchard::mapping

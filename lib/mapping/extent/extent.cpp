// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/extent/extent.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"
#include "mapping/landmark_record.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

/// derived: Chords per half circle; the approximation error is less than 1 % of the radius.
constexpr int kChordsOfHalf = 12;

}  // namespace

std::vector<Eigen::Vector2d> outline_of(const Landmark& l) {
  if (!(l.width_m > 0.0)) return {};
  const Eigen::Vector2d along(std::cos(l.direction_rad), std::sin(l.direction_rad));
  const Eigen::Vector2d half = 0.5 * std::max(0.0, l.length_m - l.width_m) * along;
  const Eigen::Vector2d middle(l.x_m, l.y_m);
  // The half circles of a round landmark share their end points, which are drawn once.
  const int num_of_half = half.isZero() ? kChordsOfHalf : kChordsOfHalf + 1;
  std::vector<Eigen::Vector2d> border;
  for (const double end : {1.0, -1.0}) {
    for (int i = 0; i < num_of_half; ++i) {
      const double angle_rad =
          l.direction_rad + geometry::kPi * (static_cast<double>(i) / kChordsOfHalf - 0.5 * end);
      border.push_back(middle + end * half +
                       0.5 * l.width_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
    }
  }
  return border;
}

namespace {

bool is_surely_no_tree(const LandmarkRecord& r, const MapperConfig& config) {
  return label_of(r, config) == detection::Label::kObject &&
         log_odds_of_tree(r.log_odds, r.num_observations, config) < tuning::kSurelyNone;
}

/// Whether a landmark is part of a clump whose extent it overlaps: two objects cannot stand in one
/// place. What is certainly no tree already is where the borders touch; here it is enough that it
/// is rather none, as for a detection.
bool overlaps(const LandmarkRecord& r, const LandmarkRecord& clump, double distance_m,
              const MapperConfig& config) {
  return clump.is_clump && is_surely_no_tree(clump, config) &&
         distance_m < extent_radius_m(clump) + extent_radius_m(r) &&
         label_of(r, config) != detection::Label::kTree && probability_of_tree(r, config) < 0.5;
}

}  // namespace

bool looks_like_a_tree(const detection::Detection& d) {
  return d.label == detection::Label::kTree || d.probability_tree > d.probability_object;
}

double extent_radius_m(const LandmarkRecord& r) {
  const double half_m = 0.5 * r.width_m;
  if (!r.is_clump) return half_m;
  // A uniform disc of radius R has a variance of R^2 / 4 per axis.
  return std::max(half_m, 2.0 * std::sqrt(std::max(0.0f, r.scatter_m2)));
}

std::int32_t touching_clump(const LandmarkTable& landmarks, std::int32_t index,
                            const MapperConfig& config) {
  const LandmarkRecord& r = landmarks[index];
  if (label_of(r, config) == detection::Label::kTree) return -1;
  const bool is_none = is_surely_no_tree(r, config);
  const double radius_m = extent_radius_m(r);
  std::int32_t best = -1;
  double best_gap_m = tuning::kTouch_m;
  landmarks.near(
      r.association_position(), radius_m + tuning::kTouch_m + 0.5 * config.object_width_max_m,
      [&](std::int32_t i, const LandmarkRecord& other) {
        if (i == index) return;
        const double other_m = extent_radius_m(other);
        const double distance_m = (other.association_position() - r.association_position()).norm();
        if (!(is_none && is_surely_no_tree(other, config)) &&
            !overlaps(r, other, distance_m, config) && !overlaps(other, r, distance_m, config)) {
          return;
        }
        if (distance_m + radius_m + other_m > config.object_width_max_m) return;
        const double gap_m = distance_m - radius_m - other_m;
        if (gap_m > best_gap_m || (gap_m == best_gap_m && (best < 0 || i > best))) return;
        best_gap_m = gap_m;
        best = i;
      });
  return best;
}

std::int32_t clump_around(const LandmarkTable& landmarks, const Candidate& candidate,
                          const MapperConfig& config) {
  if (looks_like_a_tree(*candidate.detection)) return -1;
  std::int32_t best = -1;
  double best_gap_m = tuning::kTouch_m;
  const double half_m = 0.5 * candidate.detection->width_m;
  landmarks.near(candidate.p_aligned, 0.5 * config.object_width_max_m + tuning::kTouch_m + half_m,
                 [&](std::int32_t i, const LandmarkRecord& r) {
                   if (!r.is_clump) return;
                   const double gap_m = (r.association_position() - candidate.p_aligned).norm() -
                                        extent_radius_m(r) - half_m;
                   if (gap_m > best_gap_m || (gap_m == best_gap_m && (best < 0 || i > best)))
                     return;
                   best_gap_m = gap_m;
                   best = i;
                 });
  return best;
}

namespace {

/// derived: Minimum number of observations for a scatter.
constexpr int kObservationsMin = 10;

/// Standard deviation of single observations about their mean, per axis [m].
double scatter_m(const Landmark& l) {
  return std::sqrt(0.5 * l.num_observations * (l.se_x_m * l.se_x_m + l.se_y_m * l.se_y_m));
}

bool tells(const Landmark& l) {
  return l.label == detection::Label::kTree && l.num_observations >= kObservationsMin;
}

}  // namespace

StemScatterTest::StemScatterTest(const std::vector<Landmark>& landmarks) {
  std::vector<double> of_rows_m;
  for (const Landmark& l : landmarks) {
    if (l.row > 0 && tells(l)) of_rows_m.push_back(scatter_m(l));
  }
  scatter_max_m_ = geometry::quantile(std::move(of_rows_m), tuning::kOfTrees);
}

bool StemScatterTest::contains(const Landmark& landmark) const {
  return tells(landmark) && scatter_m(landmark) <= scatter_max_m_;
}

namespace {

using Eigen::Vector2d;
using Group = std::vector<std::size_t>;  ///< indices of landmarks

/// derived: Borders closer than this touch [m]: the width of a position that GroundOccupancy tests.
constexpr double kHedgeTouch_m = 0.2;
/// derived: Leaves and bark lie this far beyond a border [m].
constexpr double kRoughSide_m = 0.05;
/// derived: Max number of landmarks used as end points of lines through a group.
constexpr std::size_t kEndsMax = 40;

Vector2d at(const Landmark& l) { return {l.x_m, l.y_m}; }

double gap_m(const Landmark& a, const Landmark& b) {
  return (at(b) - at(a)).norm() - 0.5 * (a.width_m + b.width_m);
}

/// Whether the evidence of all passages on the way between two positions passes a test.
template <class Test>
bool all_passages(const Vector2d& from, const Vector2d& to, double clear_m,
                  const PassageTest& passage, const Test& test) {
  const Vector2d way = to - from;
  const auto num = static_cast<int>(std::ceil(way.norm() / kHedgeTouch_m));
  for (int i = 0; i < num; ++i) {
    if (!test(passage(from + way * i / num, from + way * (i + 1) / num, kHedgeTouch_m, clear_m))) {
      return false;
    }
  }
  return true;
}

bool is_shut(Passage seen) { return seen == Passage::kShut; }
bool is_not_open(Passage seen) { return seen != Passage::kOpen; }

bool are_one(const Landmark& a, const Landmark& b, const PassageTest& passage) {
  const Vector2d along = (at(b) - at(a)).normalized();
  // A beam passes between two objects if it goes on from before the thinner one to beyond it.
  const double clear_m = 0.5 * std::min(a.width_m, b.width_m) + kHedgeTouch_m;
  // The borders themselves are rough: what beams hit there is no part of a passage.
  if (gap_m(a, b) > kHedgeTouch_m &&
      !all_passages(at(a) + (0.5 * a.width_m + kRoughSide_m) * along,
                    at(b) - (0.5 * b.width_m + kRoughSide_m) * along, clear_m, passage, is_shut)) {
    return false;
  }
  // Borders are those of circles: a bush and a box with a passage between may seem to touch.
  return all_passages(at(a), at(b), clear_m, passage, is_not_open);
}

/// Adjacency list of landmarks that belong to one object.
class Links {
 public:
  explicit Links(std::size_t num) : of_(num) {}
  void add(std::size_t a, std::size_t b) {
    of_[a].push_back(b);
    of_[b].push_back(a);
  }

  /// Connected components of `members`, each in ascending order.
  std::vector<Group> parts(const Group& members) const {
    std::vector<char> is_left(of_.size(), 0);
    for (const std::size_t i : members) is_left[i] = 1;
    std::vector<Group> all;
    for (const std::size_t first : members) {
      if (!is_left[first]) continue;
      Group part{first};
      is_left[first] = 0;
      for (std::size_t k = 0; k < part.size(); ++k) {
        for (const std::size_t other : of_[part[k]]) {
          if (std::exchange(is_left[other], 0)) part.push_back(other);
        }
      }
      std::sort(part.begin(), part.end());
      all.push_back(std::move(part));
    }
    return all;
  }

 private:
  std::vector<Group> of_;
};

/// Extent of a group along an axis.
struct Span {
  double from_m = 0.0, to_m = 0.0;  ///< along
  double length_m() const { return to_m - from_m; }
};

Span span_of(const std::vector<Landmark>& landmarks, const Group& group, const Vector2d& origin,
             const Vector2d& along) {
  Span span{1e300, -1e300};
  for (const std::size_t i : group) {
    const Vector2d arm = at(landmarks[i]) - origin;
    const double half_m = 0.5 * landmarks[i].width_m;
    span.from_m = std::min(span.from_m, arm.dot(along) - half_m);
    span.to_m = std::max(span.to_m, arm.dot(along) + half_m);
  }
  return span;
}

struct StraightPart {
  Group members;
  Vector2d origin{0, 0};
  Vector2d along{1, 0};
  double length_m = 0.0;
};

/// The longest straight part of a group: connected landmarks within half of `object_width_max_m` of
/// a line through two of them.
StraightPart longest_straight_part(const std::vector<Landmark>& landmarks, const Links& links,
                                   const Group& group, double object_width_max_m) {
  const std::size_t step = 1 + group.size() / kEndsMax;
  StraightPart best;
  for (std::size_t a = 0; a < group.size(); a += step) {
    for (std::size_t b = a + step; b < group.size(); b += step) {
      const Vector2d origin = at(landmarks[group[a]]);
      const Vector2d way = at(landmarks[group[b]]) - origin;
      if (way.norm() < 1e-6) continue;
      const Vector2d along = way.normalized(), across(-along.y(), along.x());
      Group beside;
      for (const std::size_t i : group) {
        const double off_m = std::abs((at(landmarks[i]) - origin).dot(across));
        if (off_m <= 0.5 * object_width_max_m) beside.push_back(i);
      }
      for (Group& part : links.parts(beside)) {
        const double length_m = span_of(landmarks, part, origin, along).length_m();
        if (length_m <= best.length_m) continue;
        best = {std::move(part), origin, along, length_m};
      }
    }
  }
  return best;
}

/// Principal axis of a group.
Vector2d main_direction(const std::vector<Landmark>& landmarks, const Group& group) {
  Vector2d mean(0, 0);
  for (const std::size_t i : group) mean += at(landmarks[i]);
  mean /= static_cast<double>(group.size());
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const std::size_t i : group) {
    const Vector2d arm = at(landmarks[i]) - mean;
    xx += arm.x() * arm.x();
    xy += arm.x() * arm.y();
    yy += arm.y() * arm.y();
  }
  const double angle_rad = 0.5 * std::atan2(2.0 * xy, xx - yy);
  return {std::cos(angle_rad), std::sin(angle_rad)};
}

/// Lateral position and width of a group relative to a line; the width is that of a uniform
/// distribution with the same scatter.
struct Across {
  double middle_m = 0.0;
  double width_m = 0.0;
};

Across across_of(const std::vector<Landmark>& landmarks, const Group& group, const Vector2d& origin,
                 const Vector2d& along) {
  const Vector2d across(-along.y(), along.x());
  const auto num = static_cast<double>(group.size());
  double sum_m = 0.0, square_m2 = 0.0;
  for (const std::size_t i : group) sum_m += (at(landmarks[i]) - origin).dot(across);
  for (const std::size_t i : group) {
    const double off_m = (at(landmarks[i]) - origin).dot(across) - sum_m / num;
    square_m2 += off_m * off_m;
  }
  return {sum_m / num, std::sqrt(12.0 * square_m2 / num)};
}

/// One object for a whole part.
Landmark joined(const std::vector<Landmark>& landmarks, const StraightPart& part) {
  const Vector2d along = main_direction(landmarks, part.members), across(-along.y(), along.x());
  const Span span = span_of(landmarks, part.members, part.origin, along);
  Landmark whole = landmarks[part.members.front()];
  whole.label = detection::Label::kObject;
  whole.probability = whole.roc_mean = 0.0;
  std::vector<double> widths_m;
  whole.num_observations = 0;
  for (const std::size_t i : part.members) {
    const Landmark& member = landmarks[i];
    whole.id = std::min(whole.id, member.id);
    whole.num_observations += member.num_observations;
    whole.roc_mean += member.roc_mean * member.num_observations;
    whole.probability = std::max(whole.probability, member.probability);
    widths_m.push_back(member.width_m);
  }
  const Across beside = across_of(landmarks, part.members, part.origin, along);
  whole.roc_mean /= std::max(1, whole.num_observations);
  // A trunk is not that long, so the appearance of the parts does not apply to the whole.
  whole.probability = std::min(whole.probability, 1.0 - whole.probability);
  // Parts are often wide along the hedge, so the narrow ones give its width.
  whole.width_m = geometry::quantile(std::move(widths_m), 0.25) + beside.width_m;
  whole.length_m = span.length_m();
  whole.direction_rad = std::atan2(along.y(), along.x());
  const Vector2d middle =
      part.origin + 0.5 * (span.from_m + span.to_m) * along + beside.middle_m * across;
  whole.x_m = middle.x();
  whole.y_m = middle.y();
  // The ends depend on which parts the scans happened to hit.
  const double along_m2 = whole.width_m * whole.width_m,
               across_m2 = beside.width_m * beside.width_m / 12.0;
  whole.covariance = {along_m2 * along.x() * along.x() + across_m2 * across.x() * across.x(),
                      along_m2 * along.x() * along.y() + across_m2 * across.x() * across.y(),
                      along_m2 * along.y() * along.y() + across_m2 * across.y() * across.y()};
  whole.se_x_m = std::sqrt(whole.covariance[0]);
  whole.se_y_m = std::sqrt(whole.covariance[2]);
  whole.width_sd_m = std::max(whole.width_sd_m, std::sqrt(across_m2));
  return whole;
}

/// Whether the middle of the shorter part lies on the line of the longer one, within their
/// widths.
bool is_in_line(const std::vector<Landmark>& landmarks, const StraightPart& a,
                const StraightPart& b) {
  const StraightPart& longer = a.length_m < b.length_m ? b : a;
  const StraightPart& shorter = a.length_m < b.length_m ? a : b;
  const Vector2d along = main_direction(landmarks, longer.members);
  const Across of_longer = across_of(landmarks, longer.members, longer.origin, along);
  const Across of_shorter = across_of(landmarks, shorter.members, longer.origin, along);
  return std::abs(of_shorter.middle_m - of_longer.middle_m) <=
         0.5 * (of_longer.width_m + of_shorter.width_m) + kHedgeTouch_m;
}

/// Whether no passage across a hedge or wall was observed free between two positions along it.
bool has_no_gate(const StraightPart& hedge, const Vector2d& along, const Across& across,
                 const Span& gap, const PositionTest& is_free) {
  // A gate must be free across the whole hedge, because foliage lets single beams in.
  const Vector2d sideways(-along.y(), along.x());
  const Vector2d middle = hedge.origin + across.middle_m * sideways;
  const double half_m = 0.5 * std::max(across.width_m, kHedgeTouch_m);
  const auto is_gate = [&](const Vector2d& p_map) {
    for (double off_m = -half_m; off_m <= half_m; off_m += kHedgeTouch_m) {
      if (!is_free(p_map + off_m * sideways)) return false;
    }
    return true;
  };
  for (double s_m = gap.from_m + kHedgeTouch_m; s_m <= gap.to_m - kHedgeTouch_m;
       s_m += kHedgeTouch_m) {
    if (is_gate(middle + s_m * along)) return false;
  }
  return true;
}

/// Joins parts in line if no passage was observed free between them and the gap is not longer
/// than the longer one: the gap was too wide to be reported, or never in view.
void join_in_line(const std::vector<Landmark>& landmarks, double object_width_max_m,
                  const PositionTest& is_free, std::vector<StraightPart>& parts) {
  const auto join = [&](StraightPart& a, const StraightPart& b) {
    Group both = a.members;
    both.insert(both.end(), b.members.begin(), b.members.end());
    const Vector2d along = main_direction(landmarks, both);
    const Span first = span_of(landmarks, a.members, a.origin, along);
    const Span second = span_of(landmarks, b.members, a.origin, along);
    const Across across = across_of(landmarks, both, a.origin, along);
    if (across.width_m > object_width_max_m || !is_in_line(landmarks, a, b)) return false;
    const Span& near = first.from_m < second.from_m ? first : second;
    const Span& far = first.from_m < second.from_m ? second : first;
    const Span gap{near.to_m, far.from_m};
    if (gap.length_m() > std::max(first.length_m(), second.length_m())) return false;
    if (!has_no_gate(a, along, across, gap, is_free)) return false;
    std::sort(both.begin(), both.end());
    a = {std::move(both), a.origin, along, std::max(near.to_m, far.to_m) - near.from_m};
    return true;
  };
  for (std::size_t a = 0; a < parts.size(); ++a) {
    for (std::size_t b = 0; b < parts.size(); ++b) {
      if (b == a || !join(parts[a], parts[b])) continue;
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(b));
      if (b < a) --a;
      b = static_cast<std::size_t>(-1);  // restart: it is longer now
    }
  }
}

/// Adds to a part what stands in its outline, and what stands in line with it at most
/// `object_width_max_m` beyond its end if no passage was observed free between them: few beams
/// reach there, so that no passage was observed to be shut either. The outline does not grow wider
/// by what is added. Sets is_part.
void add_what_stands_in_it(const std::vector<Landmark>& landmarks, const Group& members,
                           double object_width_max_m, const PassageTest& passage,
                           const PositionTest& is_free, StraightPart& part,
                           std::vector<char>& is_part) {
  const double half_m = 0.5 * joined(landmarks, part).width_m;
  for (bool is_done = false; !is_done;) {
    is_done = true;
    const Vector2d along = main_direction(landmarks, part.members), across(-along.y(), along.x());
    const Across beside = across_of(landmarks, part.members, part.origin, along);
    for (const std::size_t i : members) {
      const Vector2d arm = at(landmarks[i]) - part.origin;
      const double off_m = std::abs(arm.dot(across) - beside.middle_m);
      if (is_part[i] || off_m > half_m + 0.5 * landmarks[i].width_m) continue;
      const Span span = span_of(landmarks, part.members, part.origin, along);
      const Span own = span_of(landmarks, {i}, part.origin, along);
      const Span gap =
          own.from_m > span.to_m ? Span{span.to_m, own.from_m} : Span{own.to_m, span.from_m};
      if (gap.length_m() > object_width_max_m) continue;
      if (!has_no_gate(part, along, beside, gap, is_free)) continue;
      const auto on_line = [&](double s_m) {
        return Vector2d(part.origin + s_m * along + beside.middle_m * across);
      };
      if (gap.length_m() > 0.0 &&
          !all_passages(on_line(gap.from_m), on_line(gap.to_m),
                        0.5 * landmarks[i].width_m + kHedgeTouch_m, passage, is_not_open)) {
        continue;
      }
      part.members.push_back(i);
      is_part[i] = 1;
      is_done = false;
    }
  }
  std::sort(part.members.begin(), part.members.end());
}

/// Links pairs closer than `object_width_max_m` between which nothing passes.
Links find_links(const std::vector<Landmark>& landmarks, const Group& members,
                 double object_width_max_m, const PassageTest& passage) {
  geometry::PointGrid grid(2.0 * object_width_max_m);
  double width_most_m = 0.0;
  Links links(landmarks.size());
  for (const std::size_t i : members) {
    const Landmark& a = landmarks[i];
    width_most_m = std::max(width_most_m, a.width_m);
    std::vector<std::int32_t> near;
    grid.near(a.x_m, a.y_m, object_width_max_m + 0.5 * (a.width_m + width_most_m),
              [&](std::int32_t k) { near.push_back(k); });
    std::sort(near.begin(), near.end());
    for (const std::int32_t k : near) {
      const Landmark& b = landmarks[static_cast<std::size_t>(k)];
      if (gap_m(a, b) > object_width_max_m || !are_one(a, b, passage)) continue;
      links.add(i, static_cast<std::size_t>(k));
    }
    grid.insert(static_cast<std::int32_t>(i), a.x_m, a.y_m);
  }
  return links;
}

}  // namespace

std::vector<Landmark> join_long_objects(std::vector<Landmark> landmarks, double object_width_max_m,
                                        const PassageTest& passage, const PositionTest& is_free,
                                        const std::function<bool(const Landmark&)>& is_separate) {
  Group members;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (landmarks[i].length_m == 0.0 && !is_separate(landmarks[i])) members.push_back(i);
  }
  const Links links = find_links(landmarks, members, object_width_max_m, passage);
  std::vector<Group> groups = links.parts(members);
  std::vector<char> is_part(landmarks.size(), 0);
  std::vector<Landmark> all;
  std::vector<StraightPart> parts;
  for (std::size_t g = 0; g < groups.size(); ++g) {  // appends the remaining parts of a group
    if (groups[g].size() < 2) continue;
    const StraightPart part =
        longest_straight_part(landmarks, links, groups[g], object_width_max_m);
    if (part.length_m <= object_width_max_m) continue;
    parts.push_back(part);
    Group rest;
    for (const std::size_t i : part.members) is_part[i] = 1;
    for (const std::size_t i : groups[g]) {
      if (!is_part[i]) rest.push_back(i);
    }
    for (Group& group : links.parts(rest)) groups.push_back(std::move(group));
  }
  join_in_line(landmarks, object_width_max_m, is_free, parts);
  for (StraightPart& part : parts) {
    add_what_stands_in_it(landmarks, members, object_width_max_m, passage, is_free, part, is_part);
  }
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (!is_part[i]) all.push_back(landmarks[i]);
  }
  for (const StraightPart& part : parts) all.push_back(joined(landmarks, part));
  std::sort(all.begin(), all.end(),
            [](const Landmark& a, const Landmark& b) { return a.id < b.id; });
  return all;
}

std::vector<Vector2d> centre_line(const Landmark& l) {
  if (!(l.length_m > l.width_m)) return {at(l)};
  const Vector2d along(std::cos(l.direction_rad), std::sin(l.direction_rad));
  const double reach_m = 0.5 * (l.length_m - l.width_m);
  const double apart_m = 0.25 * std::max(kHedgeTouch_m, l.width_m);
  const auto num = static_cast<int>(std::ceil(2.0 * reach_m / apart_m));
  std::vector<Vector2d> places;
  for (int i = 0; i <= num; ++i) {
    places.push_back(at(l) + along * (reach_m * (2.0 * i / std::max(1, num) - 1.0)));
  }
  return places;
}

}  // namespace orchard::mapping

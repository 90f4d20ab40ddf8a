// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/visibility.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "geometry/visibility.hpp"
#include "mapping/compare/landmark_pairing.hpp"
#include "mapping/kind.hpp"
#include "mapping/tuning.hpp"
#include "pose/repeat_model.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// derived: the number of range bins.
constexpr std::size_t kNumRanges = VisibilityGrid::kRangeEnds_m.size();

using Rates = VisibilityGrid::Weights;

/// Fits non-negative detection rates per distance bin to the observations per second of all trees
/// (least squares by coordinate descent: convex, few unknowns). Where the data do not separate
/// bins, the nearer one gets the rate.
Rates fit_rates(const std::vector<Rates>& fractions, const std::vector<double>& per_second) {
  // derived: enough to converge.
  constexpr int kSweeps = 300;
  Rates rates{};
  std::array<Rates, kNumRanges> products{};
  Rates targets{};
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    for (std::size_t j = 0; j < kNumRanges; ++j) {
      targets[j] += fractions[i][j] * per_second[i];
      for (std::size_t k = 0; k < kNumRanges; ++k)
        products[j][k] += fractions[i][j] * fractions[i][k];
    }
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t j = 0; j < kNumRanges; ++j) {
      if (products[j][j] <= 1e-9) continue;
      double rest = targets[j];
      for (std::size_t k = 0; k < kNumRanges; ++k) {
        if (k != j) rest -= products[j][k] * rates[k];
      }
      rates[j] = std::max(0.0, rest / products[j][j]);
    }
  }
  return rates;
}

double weighted_sum(const VisibilityGrid::Seconds& times_s, const Rates& per_second) {
  double sum = 0.0;
  for (std::size_t j = 0; j < kNumRanges; ++j) sum += times_s[j] * per_second[j];
  return sum;
}

}  // namespace

DetectionMap::DetectionMap(const std::vector<Landmark>& landmarks,
                           const std::vector<std::vector<pose::PoseEstimate>>& trajectories,
                           const SensorView& view) {
  if (trajectories.empty()) return;
  is_known_ = true;
  raster_.emplace_back(landmarks, trajectories, view);
  const std::vector<Vector2d> places = landmark_positions(landmarks);
  const std::vector<VisibilityGrid::Seconds> times = raster_.front().at(places);
  const auto is_tree = [&](std::size_t i) { return may_be_tree(landmarks[i]); };
  std::vector<Rates> fractions;
  std::vector<double> per_second;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    double total_s = 0.0;
    for (const float s : times[i]) total_s += s;
    if (!is_tree(i) || total_s <= 0.0) continue;
    Rates fraction{};
    for (std::size_t j = 0; j < kNumRanges; ++j) fraction[j] = times[i][j] / total_s;
    fractions.push_back(fraction);
    per_second.push_back(landmarks[i].num_observations / total_s);
  }
  num_mapped_min_ = view.min_observations;
  per_second_ = fit_rates(fractions, per_second);
  std::vector<double> deviations;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const double expected = weighted_sum(times[i], per_second_);
    of_landmarks_.push_back({VisibilityGrid::cell_of(places[i]), expected});
    if (!is_tree(i) || expected < 3.0) continue;
    deviations.push_back(landmarks[i].num_observations / expected - 1.0);
  }
  std::sort(of_landmarks_.begin(), of_landmarks_.end());
  std::vector<double> visibilities = deviations;
  for (double& v : visibilities) v += 1.0;
  if (!visibilities.empty()) {
    clear_visibility_ =
        std::max(1e-3, geometry::quantile(std::move(visibilities), tuning::kSeenWell));
  }
  // Assume a relative spread of at least one half, even if a small map shows less.
  const double spread = deviations.empty() ? 1.0 : geometry::robust_sd(std::move(deviations));
  shape_ = std::clamp(1.0 / std::max(1e-6, spread * spread), 0.5, 4.0);
}

std::vector<double> DetectionMap::expected_observations(const std::vector<Vector2d>& p_map) const {
  std::vector<double> expected(p_map.size(), 0.0);
  if (!is_known_) return expected;
  std::vector<std::size_t> unknown;
  std::vector<Vector2d> places;
  for (std::size_t i = 0; i < p_map.size(); ++i) {
    const std::pair<VisibilityGrid::Index, double> cell(VisibilityGrid::cell_of(p_map[i]), -1.0);
    const auto found = std::lower_bound(of_landmarks_.begin(), of_landmarks_.end(), cell);
    if (found != of_landmarks_.end() && found->first == cell.first) {
      expected[i] = found->second;
    } else {
      unknown.push_back(i);
      places.push_back(p_map[i]);
    }
  }
  if (unknown.empty()) return expected;
  const std::vector<VisibilityGrid::Seconds> times = raster_.front().at(places);
  for (std::size_t k = 0; k < unknown.size(); ++k) {
    expected[unknown[k]] = weighted_sum(times[k], per_second_);
  }
  return expected;
}

double DetectionMap::visibility(double expected, const Landmark& landmark) const {
  if (expected <= 0.0) return 1.0;
  return std::clamp(landmark.num_observations / expected, 0.1, 1.0);
}

double DetectionMap::rate(double expected, const Landmark& landmark) const {
  const double chances = clear_visibility_ * expected;
  if (chances <= 0.0) return 1.0;
  return pose::detection_rate(landmark.num_observations, chances);
}

std::vector<double> DetectionMap::rates(const std::vector<Landmark>& landmarks) const {
  std::vector<double> rates = expected_observations(landmark_positions(landmarks));
  for (std::size_t i = 0; i < rates.size(); ++i) rates[i] = rate(rates[i], landmarks[i]);
  return rates;
}

double DetectionMap::probability_mapped(double expected, double rate) const {
  if (!is_known_) return 1.0;
  const double chances = clear_visibility_ * expected;
  return chances <= 0.0 ? 0.0 : pose::probability_seen_again(rate, num_mapped_min_ / chances);
}

std::vector<double> DetectionMap::probabilities_missed(
    const std::vector<Vector2d>& p_map, const DetectionMap& other,
    const std::vector<const Landmark*>& of_other) const {
  std::vector<Vector2d> p_other;
  for (const Landmark* l : of_other) p_other.push_back({l->x_m, l->y_m});
  const std::vector<double> expected = expected_observations(p_map);
  const std::vector<double> expected_there = other.expected_observations(p_other);
  std::vector<double> missed;
  for (std::size_t i = 0; i < p_map.size(); ++i) {
    const double visible = other.visibility(expected_there[i], *of_other[i]);
    const double observed = 1.0 - probability_missed(expected[i], visible);
    const double rate = other.rate(expected_there[i], *of_other[i]);
    missed.push_back(1.0 - observed * probability_mapped(expected[i], rate));
  }
  return missed;
}

/// The number of observations is negative binomial with the overdispersion of this map.
double DetectionMap::probability_missed(double expected, double visibility) const {
  if (!is_known_) return 1.0;
  return std::pow(1.0 + visibility * expected / shape_, -shape_);
}

std::function<double(const Vector2d&)> DetectionMap::probability_missed_anywhere() const {
  DetectionMap all = *this;
  if (is_known_) all.raster_.front().weigh(per_second_);
  return [all = std::move(all)](const Vector2d& p_map) {
    return all.probability_missed(all.is_known_ ? all.raster_.front().sum_at(p_map) : 0.0, 1.0);
  };
}

std::vector<Vector2d> DetectionMap::places_seen() const {
  std::vector<Vector2d> seen;
  if (!is_known_) return seen;
  VisibilityGrid all = raster_.front();
  all.weigh(per_second_);
  all.visit_sums([&](const Vector2d& p_map, double expected) {
    if (probability_missed(expected, 1.0) < 0.5) seen.push_back(p_map);
  });
  return seen;
}

namespace {

constexpr double kViewStep_m = 0.5;  ///< derived: between two views: a cell (kCell_m)
constexpr double kTurn_rad = 0.15;   ///< derived: or such a turn: as far at 3 m
constexpr int kNumBearings = 1440;   ///< derived: 0.25 degrees: a trunk of 0.1 m at 20 m covers one
constexpr double kBehind_m = 0.5;    ///< derived: behind an object: the depth of a bush

using View = VisibilityGrid::View;

/// Selects spaced poses, each weighted by the time until the next. A long stop adds no viewpoints,
/// so it counts as ten ordinary steps at most.
std::vector<View> views_of(const std::vector<pose::PoseEstimate>& trajectory,
                           const SensorView& view) {
  std::vector<const pose::PoseEstimate*> kept;
  for (const pose::PoseEstimate& p : trajectory) {
    if (!kept.empty()) {
      const pose::PoseEstimate& last = *kept.back();
      const double turned_rad = geometry::wrap_angle_rad(p.yaw_rad - last.yaw_rad);
      if (std::hypot(p.x_m - last.x_m, p.y_m - last.y_m) < kViewStep_m &&
          std::abs(turned_rad) < kTurn_rad) {
        continue;
      }
    }
    kept.push_back(&p);
  }
  std::vector<double> seconds;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const std::int64_t end = i + 1 < kept.size() ? kept[i + 1]->utime : trajectory.back().utime;
    seconds.push_back(1e-6 * static_cast<double>(end - kept[i]->utime));
  }
  const double typical_s = std::max(1e-3, geometry::median(seconds));
  std::vector<View> views;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    View v;
    v.p_laser = transform(geometry::Pose2{kept[i]->x_m, kept[i]->y_m, kept[i]->yaw_rad},
                          {view.mount_x_m, view.mount_y_m});
    v.yaw_rad = kept[i]->yaw_rad + view.mount_yaw_rad;
    v.seconds = std::clamp(seconds[i], 0.1 * typical_s, 10.0 * typical_s);
    views.push_back(v);
  }
  return views;
}

constexpr double kSectorsPerRad = kNumBearings / (2.0 * geometry::kPi);  ///< derived: of a turn

/// Sector of the bearing of `d`.
std::size_t bearing_index(const Vector2d& d) {
  const double turns = std::atan2(d.y(), d.x()) / (2.0 * geometry::kPi);
  const int index = static_cast<int>(std::floor((turns - std::floor(turns)) * kNumBearings));
  return static_cast<std::size_t>(std::min(index, kNumBearings - 1));
}

int cell_along(double coordinate_m) {
  return static_cast<int>(
      std::floor(std::clamp(coordinate_m, -5e8, 5e8) / VisibilityGrid::kCell_m));
}

/// Index of a group of `size` cells or tiles (division rounding towards minus infinity).
int group_of(int cell, int size) { return cell >= 0 ? cell / size : -((-cell + size - 1) / size); }

Vector2d centre_of(int x, int y) {
  return Vector2d((x + 0.5) * VisibilityGrid::kCell_m, (y + 0.5) * VisibilityGrid::kCell_m);
}

/// Sets the range to 0 in directions outside the laser's field of view.
void close_behind(const SensorView& view, double yaw_rad, std::vector<float>& free_m) {
  const double middle_rad = yaw_rad + 0.5 * (view.bearing_min_rad + view.bearing_max_rad);
  const double half_rad = 0.5 * (view.bearing_max_rad - view.bearing_min_rad);
  if (half_rad >= geometry::kPi) return;
  for (int b = 0; b < kNumBearings; ++b) {
    const double bearing_rad = (b + 0.5) * 2.0 * geometry::kPi / kNumBearings;
    if (std::abs(geometry::wrap_angle_rad(bearing_rad - middle_rad)) > half_rad) {
      free_m[static_cast<std::size_t>(b)] = 0.0f;
    }
  }
}

/// derived: half metres up to the last end of a bin, 16 m, and what is beyond.
constexpr std::size_t kNumSteps = 33;
/// derived: the distance bin of every half metre, of which the ends of bins are multiples.
const std::array<std::uint8_t, kNumSteps> kBinOfStep = [] {
  const auto first = VisibilityGrid::kRangeEnds_m.begin();
  std::array<std::uint8_t, kNumSteps> bins{};
  for (std::size_t k = 0; k < kNumSteps; ++k) {
    bins[k] = static_cast<std::uint8_t>(
        std::upper_bound(first, first + (kNumRanges - 1), 0.5 * static_cast<double>(k)) - first);
  }
  return bins;
}();

std::size_t bin_of(double distance_m) {
  return kBinOfStep[static_cast<std::size_t>(std::min(2.0 * distance_m, kNumSteps - 1.0))];
}

/// Points as seen from another one. Computed as vectors and without branches, since there are
/// billions of them in two large maps: a bearing is that of a polynomial where this is sure, else
/// exact.
class FewPoints {
 public:
  /// derived: divides a row of a tile; two vectors of SSE.
  static constexpr int kNum = 8;
  using Doubles = Eigen::Array<double, kNum, 1>;
  using Floats = Eigen::Array<float, kNum, 1>;
  /// derived: five times the error of the polynomial, in sectors, beyond a metre.
  static constexpr float kUnsure = 0.012f;

  /// Of points at `x_m`, `y_m` from the one that looks.
  FewPoints(const Doubles& x_m, const Doubles& y_m)
      : x_m_(x_m), y_m_(y_m), distance_m_((x_m * x_m + y_m * y_m).sqrt()) {
    const Floats x = x_m.cast<float>(), y = y_m.cast<float>();
    const Floats x_size = x.abs(), y_size = y.abs();
    const Floats t = x_size.min(y_size) / (x_size.max(y_size) + kTiny), tt = t * t;
    // physical: Abramowitz and Stegun, Handbook of Mathematical Functions, 4.4.49; to 1e-5 rad.
    const Floats acute =
        static_cast<float>(kSectorsPerRad) * t *
        (0.9998660f +
         tt * (-0.3302995f + tt * (0.1801410f + tt * (-0.0851330f + tt * 0.0208351f))));
    constexpr float kQuarter = kNumBearings / 4;
    const Floats right = (kQuarter * one_above_zero(y_size - x_size) - acute).abs();
    const Floats upper = (2.0f * kQuarter * one_above_zero(-x) - right).abs();
    bearing_ = (4.0f * kQuarter * one_above_zero(-y) - upper).abs();
  }

  Vector2d operator[](int i) const { return {x_m_[i], y_m_[i]}; }
  double distance_m(int i) const { return distance_m_[i]; }

  /// Bearing in sectors, in [0, kNumBearings], to kUnsure if the point is a metre away or more.
  float bearing(int i) const { return bearing_[i]; }

  std::size_t sector(int i) const {
    const auto index = static_cast<int>(bearing_[i]);
    const float part = bearing_[i] - static_cast<float>(index);
    const bool is_sure = part > kUnsure && part < 1.0f - kUnsure && distance_m_[i] > 1.0;
    return is_sure ? static_cast<std::size_t>(index) : bearing_index((*this)[i]);
  }

 private:
  static constexpr float kTiny = 1e-30f;  ///< derived: against 0 / 0; less than any distance

  /// 1 where a value is above 0, else 0.
  static Floats one_above_zero(const Floats& values) {
    return (values * (1.0f / kTiny)).max(0.0f).min(1.0f);
  }

  Doubles x_m_, y_m_, distance_m_;
  Floats bearing_;
};

/// Calls visit(few, i, index) for points as seen from p, at i of few: for all in the cells within
/// reach, a superset of the disc.
template <class Visit>
void look_around(const geometry::IndexedPoints& points, const Vector2d& p, double reach_m,
                 Visit&& visit) {
  FewPoints::Doubles x_m = FewPoints::Doubles::Zero(), y_m = FewPoints::Doubles::Zero();
  std::array<std::size_t, FewPoints::kNum> indices{};
  int num = 0;
  const auto look = [&] {
    const FewPoints few(x_m, y_m);
    for (int i = 0; i < num; ++i) visit(few, i, indices[static_cast<std::size_t>(i)]);
    num = 0;
  };
  points.near(p, reach_m, [&](std::int32_t of_points) {
    const auto k = static_cast<std::size_t>(of_points);
    x_m[num] = points[k].x() - p.x();
    y_m[num] = points[k].y() - p.y();
    indices[static_cast<std::size_t>(num)] = k;
    if (++num == FewPoints::kNum) look();
  });
  if (num > 0) look();
}

}  // namespace

VisibilityGrid::Index VisibilityGrid::cell_of(const Vector2d& p_map) {
  return {cell_along(p_map.x()), cell_along(p_map.y())};
}

VisibilityGrid::VisibilityGrid(const std::vector<Landmark>& landmarks,
                               const std::vector<std::vector<pose::PoseEstimate>>& trajectories,
                               const SensorView& view)
    : things_(landmark_positions(landmarks)), view_(view) {
  for (const Landmark& l : landmarks) radius_m_.push_back(0.5 * l.width_m);
  for (const auto& trajectory : trajectories) {
    const std::vector<View> of_drive = views_of(trajectory, view);
    views_.insert(views_.end(), of_drive.begin(), of_drive.end());
  }
}

/// First and last sector whose centre an object of that radius covers, at i of few; counted on
/// beyond a turn. Of small ones exact only where the polynomial is not sure.
std::pair<int, int> sectors_covered(const FewPoints& few, int i, double radius_m) {
  // derived: of a radius to a distance, below which the series of its arcsine is that to 1e-4
  // sectors.
  constexpr double kSmall = 0.1;
  const double size = radius_m / few.distance_m(i);
  if (size < kSmall && few.distance_m(i) > 1.0) {
    const auto half = static_cast<float>(
        kSectorsPerRad * size * (1.0 + size * size * (1.0 / 6.0 + size * size * (3.0 / 40.0))));
    // A turn is added, so that numbers are rounded down by a cast.
    const float begin = few.bearing(i) - half + (kNumBearings + 0.5f);
    const float end = few.bearing(i) + half + (kNumBearings - 0.5f);
    const auto first = static_cast<int>(begin), last = static_cast<int>(end);
    const float part = begin - static_cast<float>(first), rest = end - static_cast<float>(last);
    if (std::min(part, rest) > FewPoints::kUnsure &&
        std::max(part, rest) < 1.0f - FewPoints::kUnsure)
      return {first, last};
  }
  const auto [distance_m, bearing_rad, half_rad] = geometry::outline_of(few[i], radius_m);
  const double step_rad = 2.0 * geometry::kPi / kNumBearings;
  return {static_cast<int>(std::ceil((bearing_rad - half_rad) / step_rad - 0.5)) + kNumBearings,
          static_cast<int>(std::floor((bearing_rad + half_rad) / step_rad - 0.5)) + kNumBearings};
}

/// Free range from a pose in every direction of the map; 0 outside the field of view.
std::vector<float> VisibilityGrid::free_distance_m(const View& from) const {
  std::vector<float> free_m(kNumBearings, static_cast<float>(view_.reach_m));
  look_around(things_, from.p_laser, view_.reach_m,
              [&](const FewPoints& few, int i, std::size_t k) {
                const double distance_m = few.distance_m(i);
                if (distance_m > view_.reach_m || distance_m <= radius_m_[k] + 0.05) return;
                const auto [first, last] = sectors_covered(few, i, radius_m_[k]);
                for (int b = first; b <= last; ++b) {
                  float& f = free_m[static_cast<std::size_t>(b % kNumBearings)];
                  f = std::min(f, static_cast<float>(distance_m + kBehind_m));
                }
              });
  close_behind(view_, from.yaw_rad, free_m);
  return free_m;
}

std::vector<VisibilityGrid::Seconds> VisibilityGrid::at(const std::vector<Vector2d>& points) const {
  std::vector<std::pair<Index, std::size_t>> asked;  // in order of cells, near in memory, too
  for (std::size_t i = 0; i < points.size(); ++i) asked.push_back({cell_of(points[i]), i});
  std::sort(asked.begin(), asked.end());
  std::vector<Vector2d> centres;
  std::vector<std::size_t> places(points.size());
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const Index& cell = asked[i].first;
    if (i == 0 || cell != asked[i - 1].first) centres.push_back(centre_of(cell.first, cell.second));
    places[asked[i].second] = centres.size() - 1;
  }
  const geometry::IndexedPoints cells(std::move(centres));
  std::vector<Seconds> times(cells.size(), Seconds{});
  for (const View& v : views_) {
    std::vector<float> free_m;
    look_around(cells, v.p_laser, view_.reach_m, [&](const FewPoints& few, int i, std::size_t k) {
      if (free_m.empty()) free_m = free_distance_m(v);
      const double distance_m = few.distance_m(i);
      if (distance_m > view_.reach_m || distance_m > free_m[few.sector(i)]) return;
      times[k][bin_of(distance_m)] += static_cast<float>(v.seconds);
    });
  }
  std::vector<Seconds> result;
  for (const std::size_t place : places) result.push_back(times[place]);
  return result;
}

void VisibilityGrid::weigh(const Weights& per_second) {
  std::map<Index, std::vector<std::uint32_t>> views_of_block;
  const auto block_of = [](double coordinate_m) {
    return group_of(cell_along(coordinate_m), kBlockCells);
  };
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const Vector2d& p = views_[i].p_laser;
    for (int y = block_of(p.y() - view_.reach_m); y <= block_of(p.y() + view_.reach_m); ++y) {
      for (int x = block_of(p.x() - view_.reach_m); x <= block_of(p.x() + view_.reach_m); ++x) {
        views_of_block[{x, y}].push_back(static_cast<std::uint32_t>(i));
      }
    }
  }
  for (const auto& [block, views] : views_of_block) {
    Block times;
    for (const std::uint32_t i : views) add_view(views_[i], block, times);
    for (std::size_t k = 0; k < times.size(); ++k) {
      if (times[k].empty()) continue;
      const auto tile = static_cast<int>(k);
      std::vector<double>& sums = sums_[{block.first * kBlockTiles + tile % kBlockTiles,
                                         block.second * kBlockTiles + tile / kBlockTiles}];
      sums.assign(kTileCells * kTileCells, 0.0);
      for (std::size_t i = 0; i < times[k].size(); ++i) {
        sums[i % sums.size()] += times[k][i] * per_second[i / sums.size()];
      }
    }
  }
}

/// Adds what a pose sees of a block.
void VisibilityGrid::add_view(const View& from, const Index& block, Block& times) const {
  const std::vector<float> free_m = free_distance_m(from);
  const double reach_m = view_.reach_m;
  const auto seconds = static_cast<float>(from.seconds);
  const Vector2d& p = from.p_laser;
  const int x_block = block.first * kBlockCells, y_block = block.second * kBlockCells;
  const int y_last = std::min(cell_along(p.y() + reach_m), y_block + kBlockCells - 1);
  const FewPoints::Doubles of_cells = FewPoints::Doubles::LinSpaced(0, FewPoints::kNum - 1);
  for (int y = std::max(cell_along(p.y() - reach_m), y_block); y <= y_last; ++y) {
    const double dy = centre_of(0, y).y() - p.y();
    const double half_m = std::sqrt(std::max(0.0, reach_m * reach_m - dy * dy)) + kCell_m;
    const int x_first = std::max(cell_along(p.x() - half_m) - x_block, 0) / FewPoints::kNum;
    const int x_end = std::min(cell_along(p.x() + half_m) - x_block, kBlockCells - 1);
    Tile* tiles = &times[static_cast<std::size_t>((y - y_block) / kTileCells * kBlockTiles)];
    const int row = (y - y_block) % kTileCells * kTileCells;
    for (int x = x_first * FewPoints::kNum; x <= x_end; x += FewPoints::kNum) {
      Tile& tile = tiles[x / kTileCells];
      if (tile.empty()) tile.resize(kNumRanges * kTileCells * kTileCells);
      float* const cells = tile.data() + row + x % kTileCells;
      const FewPoints few((of_cells + (x_block + x + 0.5)) * kCell_m - p.x(),
                          FewPoints::Doubles::Constant(dy));
      for (int i = 0; i < FewPoints::kNum; ++i) {
        const double distance_m = few.distance_m(i);
        const bool is_seen = (distance_m <= reach_m) & (distance_m <= free_m[few.sector(i)]);
        cells[bin_of(distance_m) * kTileCells * kTileCells + static_cast<std::size_t>(i)] +=
            is_seen ? seconds : 0.0f;
      }
    }
  }
}

double VisibilityGrid::sum_at(const Vector2d& p_map) const {
  const int cx = cell_along(p_map.x()), cy = cell_along(p_map.y());
  const int tx = group_of(cx, kTileCells), ty = group_of(cy, kTileCells);
  const auto found = sums_.find({tx, ty});
  if (found == sums_.end()) return 0.0;
  return found->second[static_cast<std::size_t>((cy - ty * kTileCells) * kTileCells +
                                                (cx - tx * kTileCells))];
}

void VisibilityGrid::visit_sums(const std::function<void(const Vector2d&, double)>& visit) const {
  for (const auto& [tile, sums] : sums_) {
    for (int k = 0; k < kTileCells * kTileCells; ++k) {
      visit(centre_of(tile.first * kTileCells + k % kTileCells,
                      tile.second * kTileCells + k / kTileCells),
            sums[static_cast<std::size_t>(k)]);
    }
  }
}

}  // namespace orchard::mapping

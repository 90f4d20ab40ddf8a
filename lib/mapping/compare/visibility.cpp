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

std::vector<Vector2d> positions_of(const std::vector<Landmark>& landmarks) {
  std::vector<Vector2d> places;
  for (const Landmark& l : landmarks) places.push_back({l.x_m, l.y_m});
  return places;
}

}  // namespace

DetectionMap::DetectionMap(const std::vector<Landmark>& landmarks,
                           const std::vector<std::vector<pose::PoseEstimate>>& trajectories,
                           const SensorView& view) {
  if (trajectories.empty()) return;
  is_known_ = true;
  raster_.emplace_back(landmarks, trajectories, view);
  std::vector<Rates> fractions;
  std::vector<double> per_second;
  std::vector<Landmark> trees;
  std::copy_if(landmarks.begin(), landmarks.end(), std::back_inserter(trees),
               [](const Landmark& l) { return l.label != detection::Label::kObject; });
  const std::vector<VisibilityGrid::Seconds> times = raster_.front().at(positions_of(trees));
  for (std::size_t i = 0; i < trees.size(); ++i) {
    const VisibilityGrid::Seconds& observations = times[i];
    double total_s = 0.0;
    for (const float s : observations) total_s += s;
    if (total_s <= 0.0) continue;
    Rates fraction{};
    for (std::size_t j = 0; j < kNumRanges; ++j) fraction[j] = observations[j] / total_s;
    fractions.push_back(fraction);
    per_second.push_back(trees[i].num_observations / total_s);
  }
  num_mapped_min_ = view.min_observations;
  raster_.front().weigh(fit_rates(fractions, per_second));
  std::vector<double> deviations;
  for (const Landmark& l : landmarks) {
    const double expected = expected_observations({l.x_m, l.y_m});
    if (l.label == detection::Label::kObject || expected < 3.0) continue;
    deviations.push_back(l.num_observations / expected - 1.0);
  }
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

double DetectionMap::expected_observations(const Vector2d& p_map) const {
  if (!is_known_) return 0.0;
  return raster_.front().sum_at(p_map);
}

double DetectionMap::visibility(const Landmark& landmark) const {
  const double expected = expected_observations({landmark.x_m, landmark.y_m});
  if (expected <= 0.0) return 1.0;
  return std::clamp(landmark.num_observations / expected, 0.1, 1.0);
}

double DetectionMap::rate(const Landmark& landmark) const {
  const double chances = clear_visibility_ * expected_observations({landmark.x_m, landmark.y_m});
  if (chances <= 0.0) return 1.0;
  return pose::detection_rate(landmark.num_observations, chances);
}

double DetectionMap::probability_mapped(const Vector2d& p_map, double rate) const {
  if (!is_known_) return 1.0;
  const double chances = clear_visibility_ * expected_observations(p_map);
  return chances <= 0.0 ? 0.0 : pose::probability_seen_again(rate, num_mapped_min_ / chances);
}

double DetectionMap::probability_missed(const Vector2d& p_map, const DetectionMap& other,
                                        const Landmark& of_other) const {
  const double observed = 1.0 - probability_missed(p_map, other.visibility(of_other));
  return 1.0 - observed * probability_mapped(p_map, other.rate(of_other));
}

double DetectionMap::probability_missed(const Vector2d& p_map, double visibility) const {
  if (!is_known_) return 1.0;
  return std::pow(1.0 + visibility * expected_observations(p_map) / shape_, -shape_);
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

int cell_of(double coordinate_m) {
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

/// Neighbouring cells of a row as seen from a point. Computed as vectors and without branches,
/// since there are billions of them in two large maps: a sector is that of a polynomial where this
/// is sure, else exact.
class FewCells {
 public:
  /// derived: divides a row of a tile; two vectors of SSE.
  static constexpr int kNum = 8;

  FewCells(const Vector2d& p, int x_first, int y)
      : p_(p), x_first_(x_first), y_(y), distance_m_(), sector_() {
    const double dy = centre_of(0, y).y() - p.y();
    const Doubles dx =
        (Doubles::LinSpaced(x_first, x_first + kNum - 1) + 0.5) * VisibilityGrid::kCell_m - p.x();
    distance_m_ = (dx * dx + dy * dy).sqrt();
    const Floats x_m = dx.cast<float>(), x_size_m = x_m.abs();
    const auto y_m = static_cast<float>(dy);
    const float y_size_m = std::abs(y_m);
    const Floats t = x_size_m.min(y_size_m) / (x_size_m.max(y_size_m) + kTiny), tt = t * t;
    // physical: Abramowitz and Stegun, Handbook of Mathematical Functions, 4.4.49; to 1e-5 rad.
    const Floats acute =
        static_cast<float>(kSectorsPerRad) * t *
        (0.9998660f +
         tt * (-0.3302995f + tt * (0.1801410f + tt * (-0.0851330f + tt * 0.0208351f))));
    constexpr float kQuarter = kNumBearings / 4;
    const Floats right = (kQuarter * one_above_zero(y_size_m - x_size_m) - acute).abs();
    sector_ = (2.0f * kQuarter * one_above_zero(-x_m) - right).abs();
    if (y_m < 0.0f) sector_ = 4.0f * kQuarter - sector_;
  }

  double distance_m(int i) const { return distance_m_[i]; }

  std::size_t sector(int i) const {
    // derived: five times the error of the polynomial, in sectors, beyond a metre.
    constexpr float kUnsure = 0.012f;
    const auto index = static_cast<int>(sector_[i]);
    const float part = sector_[i] - static_cast<float>(index);
    const bool is_sure = part > kUnsure && part < 1.0f - kUnsure && distance_m_[i] > 1.0;
    return is_sure ? static_cast<std::size_t>(index)
                   : bearing_index(centre_of(x_first_ + i, y_) - p_);
  }

 private:
  using Doubles = Eigen::Array<double, kNum, 1>;
  using Floats = Eigen::Array<float, kNum, 1>;
  static constexpr float kTiny = 1e-30f;  ///< derived: against 0 / 0; less than any distance

  /// 1 where a value is above 0, else 0.
  static Floats one_above_zero(const Floats& values) {
    return (values * (1.0f / kTiny)).max(0.0f).min(1.0f);
  }

  Vector2d p_;
  int x_first_, y_;
  Doubles distance_m_;
  Floats sector_;
};

}  // namespace

VisibilityGrid::VisibilityGrid(const std::vector<Landmark>& landmarks,
                               const std::vector<std::vector<pose::PoseEstimate>>& trajectories,
                               const SensorView& view)
    : things_(positions_of(landmarks)), view_(view) {
  for (const Landmark& l : landmarks) radius_m_.push_back(0.5 * l.width_m);
  for (const auto& trajectory : trajectories) {
    const std::vector<View> of_drive = views_of(trajectory, view);
    views_.insert(views_.end(), of_drive.begin(), of_drive.end());
  }
}

/// Free range from a pose in every direction of the map; 0 outside the field of view.
std::vector<float> VisibilityGrid::free_distance_m(const View& from) const {
  std::vector<float> free_m(kNumBearings, static_cast<float>(view_.reach_m));
  for (const std::int32_t i : things_.within(from.p_laser, view_.reach_m)) {
    const auto k = static_cast<std::size_t>(i);
    const auto [distance_m, bearing_rad, half_rad] =
        geometry::outline_of(things_[k] - from.p_laser, radius_m_[k]);
    if (distance_m <= radius_m_[k] + 0.05) continue;
    const double step_rad = 2.0 * geometry::kPi / kNumBearings;
    // Directions whose centre the object covers.
    const auto first = static_cast<int>(std::ceil((bearing_rad - half_rad) / step_rad - 0.5));
    const auto last = static_cast<int>(std::floor((bearing_rad + half_rad) / step_rad - 0.5));
    for (int b = first; b <= last; ++b) {
      float& f =
          free_m[static_cast<std::size_t>(((b % kNumBearings) + kNumBearings) % kNumBearings)];
      f = std::min(f, static_cast<float>(distance_m + kBehind_m));
    }
  }
  close_behind(view_, from.yaw_rad, free_m);
  return free_m;
}

std::vector<VisibilityGrid::Seconds> VisibilityGrid::at(const std::vector<Vector2d>& points) const {
  std::map<Index, std::size_t> place_of;
  std::vector<std::size_t> places;
  std::vector<Vector2d> centres;
  for (const Vector2d& p : points) {
    const Index cell(cell_of(p.x()), cell_of(p.y()));
    const auto [place, is_new] = place_of.try_emplace(cell, centres.size());
    if (is_new) centres.push_back(centre_of(cell.first, cell.second));
    places.push_back(place->second);
  }
  const geometry::IndexedPoints cells(std::move(centres));
  std::vector<Seconds> times(cells.size(), Seconds{});
  for (const View& v : views_) {
    const std::vector<float> free_m = free_distance_m(v);
    cells.near(v.p_laser, view_.reach_m, [&](std::int32_t i) {
      const auto k = static_cast<std::size_t>(i);
      const Vector2d d = cells[k] - v.p_laser;
      const double distance_m = d.norm();
      if (distance_m > view_.reach_m || distance_m > free_m[bearing_index(d)]) return;
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
    return group_of(cell_of(coordinate_m), kBlockCells);
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
  views_ = {};
  things_ = geometry::IndexedPoints({});
}

/// Adds what a pose sees of a block.
void VisibilityGrid::add_view(const View& from, const Index& block, Block& times) const {
  const std::vector<float> free_m = free_distance_m(from);
  const double reach_m = view_.reach_m;
  const auto seconds = static_cast<float>(from.seconds);
  const Vector2d& p = from.p_laser;
  const int x_block = block.first * kBlockCells, y_block = block.second * kBlockCells;
  const int y_last = std::min(cell_of(p.y() + reach_m), y_block + kBlockCells - 1);
  for (int y = std::max(cell_of(p.y() - reach_m), y_block); y <= y_last; ++y) {
    const double dy = centre_of(0, y).y() - p.y();
    const double half_m = std::sqrt(std::max(0.0, reach_m * reach_m - dy * dy)) + kCell_m;
    const int x_first = std::max(cell_of(p.x() - half_m) - x_block, 0) / FewCells::kNum;
    const int x_end = std::min(cell_of(p.x() + half_m) - x_block, kBlockCells - 1);
    Tile* tiles = &times[static_cast<std::size_t>((y - y_block) / kTileCells * kBlockTiles)];
    const int row = (y - y_block) % kTileCells * kTileCells;
    for (int x = x_first * FewCells::kNum; x <= x_end; x += FewCells::kNum) {
      Tile& tile = tiles[x / kTileCells];
      if (tile.empty()) tile.resize(kNumRanges * kTileCells * kTileCells);
      float* const cells = tile.data() + row + x % kTileCells;
      const FewCells few(p, x_block + x, y);
      for (int i = 0; i < FewCells::kNum; ++i) {
        const double distance_m = few.distance_m(i);
        const bool is_seen = (distance_m <= reach_m) & (distance_m <= free_m[few.sector(i)]);
        cells[bin_of(distance_m) * kTileCells * kTileCells + static_cast<std::size_t>(i)] +=
            is_seen ? seconds : 0.0f;
      }
    }
  }
}

double VisibilityGrid::sum_at(const Vector2d& p_map) const {
  const int cx = cell_of(p_map.x()), cy = cell_of(p_map.y());
  const int tx = group_of(cx, kTileCells), ty = group_of(cy, kTileCells);
  const auto found = sums_.find({tx, ty});
  if (found == sums_.end()) return 0.0;
  return found->second[static_cast<std::size_t>((cy - ty * kTileCells) * kTileCells +
                                                (cx - tx * kTileCells))];
}

}  // namespace orchard::mapping

// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_tracks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"
#include "geometry/symmetric.hpp"
#include "mapping/rows/row_spacing.hpp"
#include "mapping/rows/rows.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// derived: rounds of reweighting: it converges in three.
constexpr int kFitRounds = 4;

/// derived: a step of sqrt(2) spacings is as near to one as to two, on a scale of factors.
constexpr double kSingle = 1.4142;

struct Link {
  Vector2d middle{0, 0};
  double length_m = 0.0;
  double angle_rad = 0.0;
  double spacing_m = 0.0;  ///< of what is planted around its row
  double weight = 0.0;
  Vector2d ahead{0, 0}, axis{0, 0};  ///< its way; its axis, of twice its angle, by its weight
};

/// The spacing around each chain [m]: the strongest in its spectrum and those of the chains within
/// `reach_m`, because spacings of curved rows differ across a block.
std::vector<double> spacings_around_m(const std::vector<Vector2d>& p_map,
                                      const std::vector<RowChain>& chains, double reach_m) {
  std::vector<SpacingSpectrum> own(chains.size());
  std::vector<std::size_t> chain_of(p_map.size(), chains.size());
  for (std::size_t c = 0; c < chains.size(); ++c) {
    std::vector<double> along_m;
    for (std::size_t k = 0; k < chains[c].size(); ++k) {
      const std::size_t i = index_of(chains[c][k]);
      const std::size_t before = index_of(chains[c][k > 0 ? k - 1 : k]);
      along_m.push_back((k > 0 ? along_m.back() : 0.0) + (p_map[i] - p_map[before]).norm());
      chain_of[i] = c;
    }
    own[c].add(along_m);
  }
  const geometry::IndexedPoints points(p_map);
  std::vector<double> spacings_m;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    std::set<std::size_t> around;
    for (const std::int32_t i : chains[c]) {
      for (const std::int32_t k : points.within(p_map[index_of(i)], reach_m)) {
        around.insert(chain_of[index_of(k)]);
      }
    }
    around.erase(chains.size());
    SpacingSpectrum spectrum;
    for (const std::size_t near : around) spectrum.add(own[near]);
    spacings_m.push_back(spectrum.strongest_m());
  }
  return spacings_m;
}

std::vector<Link> links_of(const std::vector<Vector2d>& p_map, const std::vector<RowChain>& chains,
                           double reach_m) {
  const std::vector<double> spacings_m = spacings_around_m(p_map, chains, reach_m);
  std::vector<Link> links;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    for (std::size_t k = 1; k < chains[c].size(); ++k) {
      const Vector2d &a = p_map[index_of(chains[c][k - 1])], &b = p_map[index_of(chains[c][k])];
      const Vector2d d = b - a;
      const double spacing_m = spacings_m[c] > 0.0 ? spacings_m[c] : d.norm();
      links.push_back({0.5 * (a + b), d.norm(), std::atan2(d.y(), d.x()), spacing_m});
    }
  }
  return links;
}

/// Direction at p [rad]: the value at p of a linear function of position, by iteratively reweighted
/// least squares (Cauchy) about `first_rad`.
double direction_at(const Vector2d& p, const std::vector<Link>& links,
                    const std::vector<std::int32_t>& near, double reach_m, double first_rad) {
  double angle_rad = first_rad;
  double scale_rad = 0.5;  // as far as a first guess may be off
  Eigen::Vector3d fit(0.0, 0.0, 0.0);
  for (int round = 0; round < kFitRounds; ++round) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    std::vector<double> offs_rad;
    for (const std::int32_t k : near) {
      const Link& link = links[index_of(k)];
      const Vector2d d = (link.middle - p) / reach_m;
      const Eigen::Vector3d row(1.0, d.x(), d.y());
      const double value = geometry::wrap_angle_rad(link.angle_rad - first_rad);
      const double off = value - row.dot(fit);
      offs_rad.push_back(std::abs(off));
      const double weight = link.weight / (1.0 + geometry::square(off / scale_rad));
      information += weight * row * row.transpose();
      right += weight * value * row;
    }
    // Links of one row alone do not tell how directions change across it.
    const double sum = information(0, 0);
    information.diagonal() += sum * Eigen::Vector3d(1e-6, 1e-3, 1e-3);
    if (sum <= 0.0) return angle_rad;
    fit = geometry::solve_symmetric(information, right);
    angle_rad = first_rad + fit(0);
    scale_rad = std::clamp(geometry::median(std::move(offs_rad)), 0.02, 0.5);
  }
  return angle_rad;
}

/// The length at which half of all length is reached. Links count by their length, so that a hedge
/// or a bush of many short ones does not outvote the rows.
double middle_by_length_m(std::vector<double> lengths_m) {
  std::sort(lengths_m.begin(), lengths_m.end());
  const double half_m = 0.5 * std::accumulate(lengths_m.begin(), lengths_m.end(), 0.0);
  double upto_m = 0.0;
  for (const double m : lengths_m) {
    upto_m += m;
    if (upto_m >= half_m) return m;
  }
  return lengths_m.back();
}

/// Spacing from links, at least one: that of those which are single steps of what is planted around
/// them; if none is, what is planted.
double spacing_of(const std::vector<Link>& links) {
  std::vector<double> single_m, planted_m;
  for (const Link& link : links) {
    const double steps = link.length_m / link.spacing_m;
    if (steps > 1.0 / kSingle && steps < kSingle) single_m.push_back(link.length_m);
    planted_m.push_back(link.spacing_m);
  }
  return middle_by_length_m(single_m.empty() ? std::move(planted_m) : std::move(single_m));
}

}  // namespace

std::vector<LocalRows> local_rows(const std::vector<Vector2d>& p_map, double seeds_spacing_m,
                                  const std::vector<RowChain>& chains) {
  std::vector<Link> links = links_of(p_map, chains, tuning::kLinkReach_spacings * seeds_spacing_m);
  if (links.empty()) return {p_map.size(), {Vector2d::UnitX(), seeds_spacing_m}};
  std::vector<Vector2d> middles;
  for (const Link& link : links) middles.push_back(link.middle);
  std::vector<LocalRows> local;
  const double spacing_m = spacing_of(links);
  // A longer link tells the direction better, but not one over a gap: it may lead to another row.
  for (Link& link : links) {
    const double spacings = link.length_m / spacing_m;
    link.weight = spacings < 1.0 ? geometry::square(spacings) : 1.0 / spacings;
    const double angle_rad = link.angle_rad;
    link.ahead = link.length_m * Vector2d(std::cos(angle_rad), std::sin(angle_rad));
    link.axis = link.weight * Vector2d(std::cos(2.0 * angle_rad), std::sin(2.0 * angle_rad));
  }
  const double reach_m = tuning::kLinkReach_spacings * spacing_m;
  Vector2d overall(0.0, 0.0);
  for (const Link& link : links) overall += link.ahead;
  overall.normalize();
  const geometry::IndexedPoints points(std::move(middles));
  for (std::size_t i = 0; i < p_map.size(); ++i) {
    const std::vector<std::int32_t> near = points.within(p_map[i], reach_m);
    if (near.empty()) {
      local.push_back({overall, spacing_m});
      continue;
    }
    // First guess: the mean axis of the links around, by length.
    Vector2d doubled(0.0, 0.0);
    for (const std::int32_t k : near) doubled += links[index_of(k)].axis;
    double first_rad = 0.5 * std::atan2(doubled.y(), doubled.x());
    Vector2d ahead(0.0, 0.0);
    for (const std::int32_t k : near) ahead += links[index_of(k)].ahead;
    if (ahead.dot(Vector2d(std::cos(first_rad), std::sin(first_rad))) < 0.0) {
      first_rad += geometry::kPi;
    }
    const double angle_rad = direction_at(p_map[i], links, near, reach_m, first_rad);
    LocalRows here{{std::cos(angle_rad), std::sin(angle_rad)}, spacing_m};
    std::vector<Link> aligned;
    for (const std::int32_t k : near) {
      if (std::cos(links[index_of(k)].angle_rad - angle_rad) < tuning::kTurnMax_cos) continue;
      aligned.push_back(links[index_of(k)]);
    }
    if (!aligned.empty()) here.spacing_m = spacing_of(aligned);
    local.push_back(here);
  }
  return local;
}

RowStep row_step(const std::vector<Vector2d>& p_map, const std::vector<LocalRows>& local,
                 std::int32_t from, std::int32_t to) {
  const LocalRows &a = local[index_of(from)], &b = local[index_of(to)];
  const Vector2d u = (a.direction + b.direction).normalized(),
                 d = p_map[index_of(to)] - p_map[index_of(from)];
  RowStep step;
  step.spacing_m = 0.5 * (a.spacing_m + b.spacing_m);
  const double along_m = u.dot(d);
  step.num_slots = static_cast<int>(std::lround(along_m / step.spacing_m));
  step.along_m = along_m - step.num_slots * step.spacing_m;
  step.beside_m = u.x() * d.y() - u.y() * d.x();
  return step;
}

RowRegularity row_regularity(const std::vector<Vector2d>& p_map,
                             const std::vector<LocalRows>& local,
                             const std::vector<RowChain>& chains) {
  std::vector<double> along, beside;
  double num_steps = 2.0, num_single = 1.0;  // as if a next tree and a gap were known before
  for (const RowChain& chain : chains) {
    if (chain.size() < 2) continue;
    ++num_steps;  // to where no tree follows the last one
    for (std::size_t k = 1; k < chain.size(); ++k) {
      const RowStep step = row_step(p_map, local, chain[k - 1], chain[k]);
      if (step.num_slots < 1) continue;
      const double spread_m = step.spacing_m * std::sqrt(step.num_slots);
      along.push_back(std::abs(step.along_m) / spread_m);
      beside.push_back(std::abs(step.beside_m) / spread_m);
      ++num_steps;
      num_single += step.num_slots == 1;
    }
  }
  RowRegularity regularity;
  if (along.empty()) return regularity;
  regularity.along_spacings = geometry::median(std::move(along)) / std::log(2.0);
  regularity.beside_spacings = geometry::median(std::move(beside)) / std::log(2.0);
  regularity.filled = num_single / num_steps;
  return regularity;
}

namespace {

/// derived: Lower limit of the spread of planted trees [m]: of a planting machine.
constexpr double kStraightest_m = 0.01;

/// derived: Of an exponential distribution 95 % are within this many means.
constexpr double kInLine_means = 3.0;

constexpr std::int32_t kNoTree = -1;  // derived: no index

/// A possible step to a tree from an earlier one.
struct Edge {
  std::int32_t from = kNoTree;
  double log_odds = 0.0;
};

class Tracker {
 public:
  Tracker(const std::vector<Vector2d>& p_map, const std::vector<double>& strengths,
          const std::vector<LocalRows>& local, const RowRegularity& regularity,
          const std::vector<char>& is_in_row)
      : p_map_(p_map),
        local_(local),
        regularity_(regularity),
        points_(p_map),
        begin_cost_(std::log(static_cast<double>(std::max<std::size_t>(2, p_map.size())))),
        edges_(p_map.size()),
        total_(p_map.size(), 0.0),
        before_(p_map.size(), kNoTree),
        rank_(p_map.size(), 0),
        is_taken_(p_map.size(), 0),
        is_changed_(p_map.size(), 1) {
    count_clutter(is_in_row);
    compare_confidences(strengths, is_in_row);
    for (std::size_t i = 0; i < p_map.size(); ++i) add_edges(static_cast<std::int32_t>(i));
  }

  std::vector<RowTrack> tracks() {
    std::vector<RowTrack> found;
    for (std::vector<std::int32_t>& part : parts()) {
      for (std::size_t k = 0; k < part.size(); ++k) rank_[index_of(part[k])] = k;
      while (part.size() > 1) {
        solve(part);
        const auto end = std::max_element(part.begin(), part.end(), [&](auto a, auto b) {
          return total_[index_of(a)] < total_[index_of(b)];
        });
        if (total_[index_of(*end)] <= 0.0) break;
        RowTrack track;
        track.log_odds = total_[index_of(*end)];
        for (std::int32_t k = *end; k != kNoTree; k = before_[index_of(k)]) {
          track.chain.push_back(k);
          is_taken_[index_of(k)] = 1;
        }
        std::reverse(track.chain.begin(), track.chain.end());
        track.log_odds_in_line = log_odds_in_line(track.chain);
        if (track.chain.size() > 1) found.push_back(std::move(track));
        part.erase(std::remove_if(part.begin(), part.end(),
                                  [&](std::int32_t k) { return is_taken_[index_of(k)] != 0; }),
                   part.end());
      }
    }
    return found;
  }

 private:
  /// Log density of a tree's position after `step`, times the area of a unit of one spacing
  /// squared.
  double log_density(const RowStep& step) const {
    const double floor = kStraightest_m / step.spacing_m, root = std::sqrt(step.num_slots);
    const double along = root * std::max(floor, regularity_.along_spacings);
    const double beside = root * std::max(floor, regularity_.beside_spacings);
    return -std::abs(step.along_m) / (along * step.spacing_m) -
           std::abs(step.beside_m) / (beside * step.spacing_m) - std::log(4.0 * along * beside);
  }

  /// Objects outside rows around each tree, per spacing squared, the tree itself not included: the
  /// number near it, and the map's mean as if one more were known from there.
  void count_clutter(const std::vector<char>& is_in_row) {
    const double area = geometry::kPi * geometry::square(tuning::kAround_spacings);
    std::vector<int> num_near(p_map_.size(), 0);
    double sum = 1.0;
    for (std::size_t i = 0; i < p_map_.size(); ++i) {
      const double reach_m = tuning::kAround_spacings * local_[i].spacing_m;
      points_.near(p_map_[i], reach_m, [&](std::int32_t j) {
        if (is_in_row[index_of(j)] || index_of(j) == i) return;
        num_near[i] += (p_map_[index_of(j)] - p_map_[i]).norm() < reach_m;
      });
      sum += num_near[i];
    }
    const double mean = sum / static_cast<double>(p_map_.size());
    for (const int num : num_near) {
      log_clutter_.push_back(std::log((num + 1.0) / (area * (1.0 + 1.0 / mean))));
    }
  }

  /// How much more frequent each tree's strength, by quartiles, is in rows than outside
  /// (logarithm).
  void compare_confidences(const std::vector<double>& strengths,
                           const std::vector<char>& is_in_row) {
    // derived: quartiles.
    constexpr std::size_t kNumBins = 4;
    std::array<double, kNumBins - 1> limits;
    for (std::size_t b = 0; b < limits.size(); ++b) {
      limits[b] = geometry::quantile(strengths, static_cast<double>(b + 1) / kNumBins);
    }
    const auto bin_of = [&](double strength) {
      return static_cast<std::size_t>(std::upper_bound(limits.begin(), limits.end(), strength) -
                                      limits.begin());
    };
    std::array<std::array<double, kNumBins>, 2> counts{};
    for (std::size_t i = 0; i < strengths.size(); ++i) {
      ++counts[is_in_row[i] ? 1 : 0][bin_of(strengths[i])];
    }
    std::array<double, kNumBins> ratios{};
    const std::array<double, 2> sums{std::accumulate(counts[0].begin(), counts[0].end(), 0.0),
                                     std::accumulate(counts[1].begin(), counts[1].end(), 0.0)};
    for (std::size_t b = 0; b < kNumBins; ++b) {
      // One tree more in each group, as all trees are: shares of few trees are uncertain.
      const double share = std::max(1.0, counts[0][b] + counts[1][b]) / (sums[0] + sums[1]);
      ratios[b] = std::log((counts[1][b] + share) / (sums[1] + 1.0)) -
                  std::log((counts[0][b] + share) / (sums[0] + 1.0));
    }
    for (const double strength : strengths) log_confidence_.push_back(ratios[bin_of(strength)]);
  }

  /// After a gap the next slot is filled as probably as not.
  static double log_slots(int num_slots, double filled) {
    if (num_slots == 1) return std::log(filled);
    return std::log(1.0 - filled) - (num_slots - 1) * std::log(2.0);
  }

  /// Number of trees beside the way from one tree to the next, as near to it as a row's trees, the
  /// first of the two included.
  int num_in_line(std::int32_t from, std::int32_t to) const {
    const Vector2d &a = p_map_[index_of(from)], d = p_map_[index_of(to)] - a;
    const double length_m = d.norm();
    const double beside_m =
        kInLine_means * local_[index_of(from)].spacing_m *
        std::max(regularity_.beside_spacings, kStraightest_m / local_[index_of(from)].spacing_m);
    int num = 1;
    points_.near(a + 0.5 * d, 0.5 * length_m + beside_m, [&](std::int32_t k) {
      if (k == from || k == to) return;
      const Vector2d way = p_map_[index_of(k)] - a;
      const double along_m = way.dot(d) / length_m;
      const double off_m = (d.x() * way.y() - d.y() * way.x()) / length_m;
      num += along_m >= 0.0 && along_m < length_m && std::abs(off_m) < beside_m;
    });
    return num;
  }

  /// Log odds of a chain against objects at any distances on a line, such as a hedge.
  double log_odds_in_line(const RowChain& chain) const {
    double sum = 0.0;
    int num_trees = 0, num_slots = 0, num_single = 0;
    const auto num_steps = static_cast<double>(chain.size() - 1);
    std::vector<RowStep> steps;
    for (std::size_t k = 1; k < chain.size(); ++k) {
      steps.push_back(row_step(p_map_, local_, chain[k - 1], chain[k]));
      num_trees += num_in_line(chain[k - 1], chain[k]);
      num_slots += steps.back().num_slots;
      num_single += steps.back().num_slots == 1;
    }
    // A row has gaps of its own: its steps count, and two as the map's rows have them.
    const double filled = (num_single + 2.0 * regularity_.filled) / (num_steps + 2.0);
    for (const RowStep& step : steps) {
      const double spread = std::sqrt(step.num_slots) *
                            std::max(regularity_.along_spacings, kStraightest_m / step.spacing_m);
      sum += log_slots(step.num_slots, filled) - std::log(2.0 * spread) -
             std::abs(step.along_m) / (spread * step.spacing_m);
    }
    // Objects on a line are a Poisson process at the density that is observed, and so is what
    // stands between the trees of a row.
    const auto log_poisson = [&](double num) {
      return num > 0.0 ? num * std::log(num / num_slots) - num : 0.0;
    };
    return sum + log_poisson(num_trees - num_steps) - log_poisson(num_trees);
  }

  void add_edges(std::int32_t to) {
    const double clutter = log_clutter_[index_of(to)];
    const double radius_m = (kGapMax_slots + 0.5) * 1.2 * local_[index_of(to)].spacing_m;
    points_.near(p_map_[index_of(to)], radius_m, [&](std::int32_t from) {
      if (from == to) return;
      const Vector2d d = p_map_[index_of(to)] - p_map_[index_of(from)];
      const Vector2d &u = local_[index_of(from)].direction, &v = local_[index_of(to)].direction;
      const double straight_m = tuning::kTurnMax_cos * d.norm();
      if (v.dot(d) < straight_m || u.dot(d) < straight_m || u.dot(v) < tuning::kTurnMax_cos) return;
      const RowStep step = row_step(p_map_, local_, from, to);
      if (step.num_slots < 1 || step.num_slots > kGapMax_slots) return;
      const double log_odds =
          log_slots(step.num_slots, regularity_.filled) + log_density(step) - clutter;
      // Below this a new row begins.
      if (log_odds <= -begin_cost_) return;
      edges_[index_of(to)].push_back({from, log_odds});
    });
    std::sort(edges_[index_of(to)].begin(), edges_[index_of(to)].end(),
              [](const Edge& a, const Edge& b) { return a.from < b.from; });
  }

  /// Trees that possible steps connect, each part in an order in which steps lead ahead.
  std::vector<std::vector<std::int32_t>> parts() const {
    const std::size_t num = p_map_.size();
    std::vector<std::int32_t> root(num);
    std::iota(root.begin(), root.end(), 0);
    const auto root_of = [&](std::int32_t i) {
      while (root[index_of(i)] != i) i = root[index_of(i)] = root[index_of(root[index_of(i)])];
      return i;
    };
    std::vector<std::vector<std::int32_t>> after(num);
    std::vector<std::size_t> num_open(num, 0);
    for (std::size_t i = 0; i < num; ++i) {
      num_open[i] = edges_[i].size();
      for (const Edge& edge : edges_[i]) {
        after[index_of(edge.from)].push_back(static_cast<std::int32_t>(i));
        const std::int32_t a = root_of(edge.from), b = root_of(static_cast<std::int32_t>(i));
        root[index_of(std::max(a, b))] = std::min(a, b);
      }
    }
    std::vector<std::vector<std::int32_t>> all(num);
    std::vector<char> is_placed(num, 0);
    std::vector<std::int32_t> ready;
    const auto place = [&](std::int32_t first) {
      ready.assign(1, first);
      is_placed[index_of(first)] = 1;
      while (!ready.empty()) {
        const std::int32_t i = ready.back();
        ready.pop_back();
        all[index_of(root_of(i))].push_back(i);
        for (const std::int32_t k : after[index_of(i)]) {
          if (num_open[index_of(k)] > 0) --num_open[index_of(k)];
          if (num_open[index_of(k)] > 0 || is_placed[index_of(k)]) continue;
          is_placed[index_of(k)] = 1;
          ready.push_back(k);
        }
      }
    };
    for (std::size_t i = 0; i < num; ++i) {
      if (!is_placed[i] && edges_[i].empty()) place(static_cast<std::int32_t>(i));
    }
    for (std::size_t i = 0; i < num; ++i) {  // a ring is opened at its first tree
      if (!is_placed[i]) place(static_cast<std::int32_t>(i));
    }
    all.erase(std::remove_if(all.begin(), all.end(), [](const auto& part) { return part.empty(); }),
              all.end());
    return all;
  }

  /// Maximum log odds of the rows that end at each tree of a part (dynamic programming). After the
  /// first time only of trees to which trees led that were taken since: for the others the best way
  /// is what it was, since all other ways only became worse.
  void solve(const std::vector<std::int32_t>& part) {
    for (const std::int32_t i : part) {
      std::int32_t& before = before_[index_of(i)];
      if (before != kNoTree) {
        is_changed_[index_of(i)] = is_taken_[index_of(before)] | is_changed_[index_of(before)];
      }
      if (is_changed_[index_of(i)] == 0) continue;
      double best = -begin_cost_;
      before = kNoTree;
      for (const Edge& edge : edges_[index_of(i)]) {
        const std::size_t from = index_of(edge.from);
        if (is_taken_[from] != 0 || rank_[from] > rank_[index_of(i)]) continue;
        const double through = total_[from] + edge.log_odds;
        if (through <= best) continue;
        best = through;
        before = edge.from;
      }
      total_[index_of(i)] = best + log_confidence_[index_of(i)];
    }
    for (const std::int32_t i : part) is_changed_[index_of(i)] = 0;
  }

  const std::vector<Vector2d>& p_map_;
  const std::vector<LocalRows>& local_;
  RowRegularity regularity_;
  geometry::IndexedPoints points_;
  double begin_cost_ = 0.0;
  std::vector<double> log_clutter_, log_confidence_;
  std::vector<std::vector<Edge>> edges_;
  std::vector<double> total_;
  std::vector<std::int32_t> before_;
  std::vector<std::size_t> rank_;  ///< in the order of its part
  std::vector<char> is_taken_, is_changed_;
};

}  // namespace

std::vector<RowTrack> row_tracks(const std::vector<Vector2d>& p_map,
                                 const std::vector<double>& strengths,
                                 const std::vector<LocalRows>& local,
                                 const std::vector<RowChain>& known) {
  std::vector<char> is_in_row(p_map.size(), 0);
  for (const RowChain& chain : known) {
    if (chain.size() < kRowTreesMin) continue;
    for (const std::int32_t i : chain) is_in_row[index_of(i)] = 1;
  }
  return Tracker(p_map, strengths, local, row_regularity(p_map, local, known), is_in_row).tracks();
}

}  // namespace orchard::mapping

// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/two_things.hpp"

#include <algorithm>

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kScansMost = 100;
constexpr double kPlace_m = 0.25;    ///< what lies so near to a place is seen there
constexpr double kBetween_m = 0.15;  ///< the same of the middle between two places
constexpr int kAtOnceLeast = 5;
constexpr double kAtOnceShare = 0.3;
constexpr int kSeenLeast = 10;
constexpr double kSeenShare = 0.5;
constexpr double kBetweenShare = 0.5;

/// Per scan that has pieces, in order: whether one of them lies that near to a place.
std::vector<char> scans_showing(const std::vector<Piece>& pieces, const Vector2d& place,
                                double reach_m) {
  std::vector<char> shown;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (i == 0 || pieces[i].scan != pieces[i - 1].scan) shown.push_back(0);
    if ((pieces[i].p_map - place).squaredNorm() < reach_m * reach_m) shown.back() = 1;
  }
  return shown;
}

int count(const std::vector<char>& shown) {
  return static_cast<int>(std::count(shown.begin(), shown.end(), 1));
}

bool are_two(const std::vector<Piece>& pieces, const Vector2d& a, const Vector2d& b,
             const std::vector<char>& at_a, const std::vector<char>& at_b) {
  int both = 0;
  for (std::size_t i = 0; i < at_a.size(); ++i) both += at_a[i] & at_b[i];
  const int fewer = std::min(count(at_a), count(at_b));
  if (both < kAtOnceLeast || both < kAtOnceShare * fewer) return false;
  return count(scans_showing(pieces, 0.5 * (a + b), kBetween_m)) <= kBetweenShare * fewer;
}

/// The middle of what is seen at the place that most scans show, of those that `is_allowed`.
template <class IsAllowed>
std::optional<Vector2d> best_place(const std::vector<Piece>& pieces, const IsAllowed& is_allowed) {
  int most = 0;
  Vector2d best;
  for (const Piece& piece : pieces) {
    if (!is_allowed(piece.p_map)) continue;
    const int num = count(scans_showing(pieces, piece.p_map, kPlace_m));
    if (num <= most) continue;
    most = num;
    best = piece.p_map;
  }
  if (most == 0) return std::nullopt;
  Vector2d sum = Vector2d::Zero();
  int num = 0;
  for (const Piece& piece : pieces) {
    if ((piece.p_map - best).squaredNorm() >= kPlace_m * kPlace_m) continue;
    sum += piece.p_map;
    ++num;
  }
  return sum / num;
}

}  // namespace

std::vector<Piece> pieces_around(const ObservationStore& observations, std::int32_t head,
                                 const Vector2d& p_map, double reach_m) {
  std::vector<std::int32_t> scans;
  for (const std::int32_t k : observations.newest_of(head, kScansMost)) {
    scans.push_back(observations[k].scan);
  }
  std::sort(scans.begin(), scans.end());
  scans.erase(std::unique(scans.begin(), scans.end()), scans.end());
  std::vector<Piece> pieces;
  for (const std::int32_t scan : scans) {
    for (std::int32_t k = observations.first_of(scan); k < observations.first_of(scan + 1); ++k) {
      const Vector2d p = observations.p_map(k);
      if ((p - p_map).squaredNorm() < reach_m * reach_m) pieces.push_back({k, scan, p});
    }
  }
  return pieces;
}

bool are_two_things(const std::vector<Piece>& pieces, const Vector2d& a, const Vector2d& b) {
  return are_two(pieces, a, b, scans_showing(pieces, a, kPlace_m),
                 scans_showing(pieces, b, kPlace_m));
}

std::optional<TwoPlaces> two_places(const std::vector<Piece>& pieces, double apart_m) {
  const auto first = best_place(pieces, [](const Vector2d&) { return true; });
  if (!first) return std::nullopt;
  const auto second = best_place(
      pieces, [&](const Vector2d& p) { return (p - *first).squaredNorm() > apart_m * apart_m; });
  if (!second || (*second - *first).norm() <= apart_m) return std::nullopt;
  const auto at_first = scans_showing(pieces, *first, kPlace_m);
  const auto at_second = scans_showing(pieces, *second, kPlace_m);
  const int num = count(at_second);
  if (num < kSeenLeast || num < kSeenShare * count(at_first)) return std::nullopt;
  if (!are_two(pieces, *first, *second, at_first, at_second)) return std::nullopt;
  return TwoPlaces{*first, *second};
}

}  // namespace orchard::mapping

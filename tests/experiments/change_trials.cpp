// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdio>

#include "experiments/changed_block.hpp"
#include "experiments/two_map_trials.hpp"

namespace orchard::trials {
namespace {

constexpr std::array<Change, 5> kKinds{Change::kMissing, Change::kNew, Change::kMoved,
                                       Change::kGrown, Change::kThinner};
constexpr std::array<double, 6> kConfidenceEnds{0.8, 0.9, 0.95, 0.99, 0.999, 1.01};

struct Score {
  int num_true = 0, right = 0, wrong = 0;
  double precision() const { return right + wrong > 0 ? 1.0 * right / (right + wrong) : 1.0; }
  double recall() const { return num_true > 0 ? 1.0 * right / num_true : 1.0; }
};

struct Bin {
  int claims = 0, right = 0;
  double sum = 0.0;
};

struct Scores {
  std::array<Score, kKinds.size()> of_kind;
  std::array<Bin, kConfidenceEnds.size()> bins;
  int num_compared = 0, num_unaligned = 0, num_not_seen = 0;
};

bool is_claim(Change change) { return change != Change::kUnchanged && change != Change::kNotSeen; }

std::size_t kind_of(Change change) {
  return static_cast<std::size_t>(std::find(kKinds.begin(), kKinds.end(), change) - kKinds.begin());
}

void judge(const DrivenMap& a, const DrivenMap& b, const std::map<int, Change>& truth,
           Scores& scores) {
  const DetectionMap view_a = view_of(a), view_b = view_of(b);
  const MapAlignment alignment =
      align_maps(a.landmarks, b.landmarks, view_a, view_b, MapAlignmentConfig{});
  if (alignment.status != AlignmentStatus::kAligned) {
    ++scores.num_unaligned;
    std::printf("not aligned: %s\n", alignment.reason.c_str());
    return;
  }
  for (const auto& [tree, change] : truth) ++scores.of_kind[kind_of(change)].num_true;
  const MapComparison comparison =
      compare_maps(a.landmarks, b.landmarks, view_a, view_b, alignment, ComparisonConfig{});
  for (const MapChange& c : comparison.changes) {
    ++scores.num_compared;
    scores.num_not_seen += c.change == Change::kNotSeen;
    if (!is_claim(c.change)) continue;
    const int tree_a = c.a >= 0 ? a.tree_of[static_cast<std::size_t>(c.a)] : -1;
    const int tree_b = c.b >= 0 ? b.tree_of[static_cast<std::size_t>(c.b)] : -1;
    const auto found = truth.find(tree_a >= 0 ? tree_a : tree_b);
    const bool is_right = found != truth.end() && found->second == c.change &&
                          (tree_a < 0 || tree_b < 0 || tree_a == tree_b);
    Score& score = scores.of_kind[kind_of(c.change)];
    (is_right ? score.right : score.wrong)++;
    std::size_t k = 0;
    while (c.confidence >= kConfidenceEnds[k]) ++k;
    ++scores.bins[k].claims;
    scores.bins[k].right += is_right;
    scores.bins[k].sum += c.confidence;
  }
}

int num_wrong(const Scores& scores) {
  int sum = 0;
  for (const Score& score : scores.of_kind) sum += score.wrong;
  return sum;
}

/// Widths by which standard deviation in each map.
bool run_with(const Seeds& seeds, double width_sd_m) {
  std::printf("widths with a standard deviation of %.0f mm in each map\n", 1e3 * width_sd_m);
  Scores changed, same;
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; ++seed) {
    Dice dice(seed);
    Block block = plant_block(dice, 10, 30);
    Drive drive;
    drive.width_sd_m = width_sd_m;
    const DrivenMap a = drive_through(block, drive, dice);
    Drive later = drive;
    later.T_map_block = {dice.uniform(-2, 2), dice.uniform(-2, 2), dice.uniform(-0.03, 0.03)};
    judge(a, drive_through(block, later, dice), {}, same);
    const std::map<int, Change> truth = change_block(block, DayChanges{}, dice);
    judge(a, drive_through(block, later, dice), truth, changed);
  }
  bool is_reached = changed.num_unaligned + same.num_unaligned == 0;
  std::printf("kind       true  right  wrong  precision  recall   (wanted 0.95)\n");
  for (std::size_t k = 0; k < kKinds.size(); ++k) {
    const Score& s = changed.of_kind[k];
    std::printf("%-9s %5d  %5d  %5d  %9.3f  %6.3f\n", change_text(kKinds[k]), s.num_true, s.right,
                s.wrong, s.precision(), s.recall());
    is_reached = is_reached && (s.num_true == 0 || (s.precision() >= 0.95 && s.recall() >= 0.95));
  }
  std::printf("compared %d, not seen %d, not aligned %d\n", changed.num_compared,
              changed.num_not_seen, changed.num_unaligned);
  std::printf("unchanged block: %d false of %d (%.2f %%, wanted 1 %%)\n", num_wrong(same),
              same.num_compared, 100.0 * num_wrong(same) / std::max(1, same.num_compared));
  is_reached = is_reached && 100 * num_wrong(same) <= same.num_compared;
  std::printf("confidence below  claims  mean confidence  right\n");
  for (std::size_t k = 0; k < kConfidenceEnds.size(); ++k) {
    const Bin& bin = changed.bins[k];
    if (bin.claims == 0) continue;
    std::printf("%16.3f  %6d  %15.4f  %.4f\n", std::min(1.0, kConfidenceEnds[k]), bin.claims,
                bin.sum / bin.claims, 1.0 * bin.right / bin.claims);
  }
  return is_reached;
}

}  // namespace

bool run_changes(const Seeds& seeds) {
  const bool is_reached = run_with(seeds, 0.004);
  std::printf("\n");
  run_with(seeds, 0.006);  // 20 mm are no more than three standard errors: not all can be found
  return is_reached;
}

}  // namespace orchard::trials

// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/slam_map.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <utility>

#include "geometry/pose2.hpp"
#include "pose/graph/georeference.hpp"
#include "pose/graph/submaps.hpp"
#include "pose/slam/same_tree.hpp"

namespace orchard::pose {

using geometry::compose;
using geometry::rotation;
using geometry::transform;
namespace {

using Interval = std::pair<double, double>;  // of travel [m]

/// Returns the intervals of travel in which landmarks tracked now were observed, plus a margin that
/// does not reach back before the keyframe `joined_from`.
std::vector<Interval> tracked_intervals(const SlamGraph& graph, int session_start, int joined_from,
                                        double range_m) {
  const double margin_m = kCovisibleTravel_ranges * range_m;
  const std::vector<Keyframe>& keyframes = graph.keyframes;
  const double joined_m = keyframes[joined_from].travel_m;
  std::vector<int> observed;
  for (int k = static_cast<int>(keyframes.size()) - 1; k >= session_start; --k) {
    if (keyframes.back().travel_m - keyframes[k].travel_m > kTrackedTravel_ranges * range_m) break;
    for (const SlamObservation& s : keyframes[k].observations) observed.push_back(s.landmark);
  }
  std::sort(observed.begin(), observed.end());
  observed.erase(std::unique(observed.begin(), observed.end()), observed.end());
  std::vector<Interval> intervals;
  for (const int l : observed) {
    if (!graph.landmarks[l].confirmed) continue;
    for (const int k : graph.landmarks[l].keyframes) {
      const double travel_m = keyframes[k].travel_m;
      const double first_m = k >= joined_from ? joined_m : 0.0;
      intervals.emplace_back(std::max(first_m, travel_m - margin_m), travel_m + margin_m);
    }
  }
  std::sort(intervals.begin(), intervals.end());
  std::vector<Interval> joined;
  for (const Interval& s : intervals) {
    if (!joined.empty() && s.first <= joined.back().second) {
      joined.back().second = std::max(joined.back().second, s.second);
    } else {
      joined.push_back(s);
    }
  }
  return joined;
}

bool observed_in(const SlamGraph& graph, const SlamLandmark& landmark,
                 const std::vector<Interval>& intervals) {
  auto interval = intervals.begin();
  for (const int k : landmark.keyframes) {
    const double travel_m = graph.keyframes[k].travel_m;
    while (interval != intervals.end() && interval->second < travel_m) ++interval;
    if (interval == intervals.end()) return false;
    if (interval->first <= travel_m) return true;
  }
  return false;
}

// derived: travel between the position fixes that georeference the map [m], large compared with
// their error; a position three standard deviations from the path contradicts it.
constexpr double kPlacementTravel_m = 5.0;
constexpr double kContradicts_sigma = 3.0;

// derived: larger graphs are solved by submaps while driving, to limit the delay. Matching and
// windows cost a keyframe the time of kKeyframeWork multiplications; the solves of the whole graph
// may cost a quarter of it. A solve takes the time of some 16 factorisations, and each keyframe
// takes part in one at the end and, since the graph is solved whenever it has grown by a tenth, in
// ten before. The matrix of all keyframes at the end has 16 MiB, 12 bytes an entry. A solve for
// each position would cost quadratically in the length of the drive.
constexpr int kFineSolveKeyframes = 500;
constexpr double kKeyframeWork = 4e7;
constexpr double kFinalWork_per_keyframe = 0.25 * kKeyframeWork / 16.0;
constexpr double kSubmapWork_per_keyframe = kFinalWork_per_keyframe / 11.0;
constexpr std::size_t kFinalEntriesMax = (std::size_t{16} << 20) / 12;
constexpr double kPositionGrowth = 0.01;
constexpr int kPositionKeyframes = 4;

// derived: landmarks enter the local map some keyframes before they come into view [m].
constexpr double kLocalMapMargin_m = 3.0;

}  // namespace

double position_sd_m(const Eigen::Matrix3d& P) {
  return std::sqrt(std::max({P(0, 0), P(1, 1), 0.0}));
}

std::vector<int> local_map(const SlamGraph& graph, const geometry::PointGrid& index,
                           int session_start, int joined_from, double range_m, double radius_m) {
  std::vector<int> found;
  if (graph.keyframes.empty()) return found;
  const Keyframe& now = graph.keyframes.back();
  const std::vector<Interval> intervals =
      tracked_intervals(graph, session_start, joined_from, range_m);
  for (const int l : index.near(now.T_map_base.head<2>(), radius_m)) {
    const SlamLandmark& landmark = graph.landmarks[l];
    if (!landmark.alive || landmark.keyframes.empty()) continue;
    const int last = landmark.keyframes.back();
    const bool recent = last >= session_start && now.travel_m - graph.keyframes[last].travel_m <=
                                                     kRecentTravel_ranges * range_m;
    if (recent || (landmark.confirmed && observed_in(graph, landmark, intervals)))
      found.push_back(l);
  }
  return found;
}

SlamMap::SlamMap(const SlamConfig& config, std::shared_ptr<ChunkAllocator> memory)
    : calibration(CalibrationPrior::initial(config)), config_(config) {
  graph.calibrations.push_back(calibration.mean);
  graph.calibration_walk_sd = initial_walk_sd(config);
  graph.memory = std::make_shared<SlamObservationStore>(
      memory ? std::move(memory) : std::make_shared<HeapChunkAllocator>());
}

double SlamMap::local_sd_m() const {
  return position_sd_m(graph.keyframes.back().local_covariance);
}

bool SlamMap::is_session_georeferenced() const {
  return graph.georeferenced &&
         std::any_of(graph.keyframes.begin() + session_start, graph.keyframes.end(),
                     [](const Keyframe& k) { return !k.positions.empty(); });
}

double SlamMap::detection_range_m() const {
  return std::min(coverage.range_max_m(), config_.observation_range_max_m);
}

CalibrationPrior SlamMap::calibration_at(int interval) const {
  return calibration.after(std::max(0, interval + 1 - num_calibrated), graph.calibration_walk_sd,
                           config_);
}

void SlamMap::start_session(bool was_lost) {
  lost = lost || was_lost;
  session_start = newest();
  if (graph.keyframes.back().motion.has_guess && local_sd_m() > config_.lost_sd_m) {
    severed_at_ = session_start;
  }
  graph.keyframes.back().local_covariance.setZero();
}

void SlamMap::refresh_local() {
  // Where the motion to the session was guessed, what was seen before may lie anywhere, and in a
  // row some trunk of it fits: unless the pose is known otherwise, a loop closure has to join it.
  const bool is_placed = position_sd_m(graph.keyframes.back().covariance) <= config_.lost_sd_m;
  const int joined_from = is_placed ? 0 : std::min(session_start, severed_at_);
  local = local_map(graph, index, session_start, joined_from, detection_range_m(),
                    detection_range_m() + kLocalMapMargin_m);
}

int SlamMap::add_landmark(const ScanPoint& point) {
  const Keyframe& keyframe = graph.keyframes.back();
  const Eigen::Matrix2d R = rotation(keyframe.T_map_base.z());
  SlamLandmark landmark;
  landmark.p_map = transform(keyframe.T_map_base, point.p_base);
  landmark.information = (R * point.covariance * R.transpose()).inverse();
  graph.landmarks.push_back(landmark);
  const int id = static_cast<int>(graph.landmarks.size()) - 1;
  index.insert(id, landmark.p_map);
  local.push_back(id);
  return id;
}

bool SlamMap::solve(SolveReason reason, const std::function<bool(const SlamGraph&)>& accept) {
  num_solved = static_cast<int>(graph.keyframes.size());
  const bool is_closure =
      reason == SolveReason::kLoopClosure || reason == SolveReason::kDuplicatesAtEnd;
  const bool is_end = reason == SolveReason::kEndOfDrive || reason == SolveReason::kDuplicatesAtEnd;
  GraphSolution solution;
  if (num_solved <= kFineSolveKeyframes) {
    solution = solve_graph(graph, is_closure, config_);
  } else if (is_end) {
    solution = solve_graph(graph, is_closure, config_,
                           {kFinalEntriesMax, kFinalWork_per_keyframe * num_solved});
  } else {
    solution.is_beyond_limits = true;
  }
  if (solution.is_beyond_limits) solution = solve_by_submaps(is_closure);
  if (!solution.solved || !accept(graph)) return false;
  const Eigen::Matrix3d P = solution.calibration_covariance.value_or(calibration.covariance);
  if (P.allFinite()) {
    calibration = {newest_calibration(), P};
    num_calibrated = static_cast<int>(graph.calibrations.size());
  }
  num_merged = merge_same_trees();
  std::vector<SlamGraph::Update> updates;
  for (const SlamLandmark& l : graph.landmarks) {
    updates.push_back(l.keyframes.empty()      ? SlamGraph::Update::kNone
                      : l.keyframes.size() < 2 ? SlamGraph::Update::kPosition
                                               : SlamGraph::Update::kInformation);
  }
  graph.update_landmarks(updates);
  num_kept_ = 0;  // merging may have changed the observations of any keyframe
  archive_old_observations();
  rebuild_index();
  refresh_local();
  corrected = true;
  return true;
}

/// Solves by submaps, twice as long as before where the predicted work is too much: the more often
/// a drive returns to the same trees, the fuller the factor.
GraphSolution SlamMap::solve_by_submaps(bool is_closure) {
  SolveLimits limits;
  limits.factor_work = kSubmapWork_per_keyframe * static_cast<double>(graph.keyframes.size());
  while (true) {
    SubmapGraph submaps = submaps_of(graph, config_);
    if (config_.submap_length_m > graph.keyframes.back().travel_m) limits = {};  // no longer ones
    const GraphSolution solution = solve_graph(submaps.graph, is_closure, config_, limits);
    if (solution.solved) back_substitute(submaps, graph);
    if (!solution.is_beyond_limits) return solution;
    config_.submap_length_m *= 2.0;
  }
}

/// Landmarks are dropped only within two sight ranges, and keyframes corrected only within the
/// window; older observations seldom change.
void SlamMap::archive_old_observations() {
  const double still_m = kRecentTravel_ranges * detection_range_m();
  const double travel_m = graph.keyframes.back().travel_m;
  const int end = newest() - config_.window_keyframes;
  for (; num_kept_ < end && travel_m - graph.keyframes[num_kept_].travel_m > still_m; ++num_kept_) {
    graph.keyframes[num_kept_].observations.keep(*graph.memory);
  }
}

int SlamMap::merge_same_trees() {
  rebuild_index();
  std::map<int, int> merged;  // per landmark that was merged: into which
  const auto now = [&](int l) {
    for (auto at = merged.find(l); at != merged.end(); at = merged.find(l)) l = at->second;
    return l;
  };
  for (const auto& [l, other] : find_same_trees(graph, index, coverage, config_)) {
    const int a = std::min(now(l), now(other)), b = std::max(now(l), now(other));
    if (a == b) continue;
    // A merge before this one may have brought observations of both by one keyframe.
    if (graph.co_observed(a, b) && !trunks_overlap(graph.landmarks[a], graph.landmarks[b]))
      continue;
    graph.merge(b, a);
    merged[b] = a;
  }
  return static_cast<int>(merged.size());
}

void SlamMap::rebuild_index() {
  index.clear();
  for (int l = 0; l < static_cast<int>(graph.landmarks.size()); ++l) {
    if (graph.landmarks[l].alive) index.insert(l, graph.landmarks[l].p_map);
  }
}

void SlamMap::process_absolute_position() {
  if (!graph.georeferenced) {
    georeference();
    return;
  }
  const double solve_at = num_solved * (1.0 + kPositionGrowth) + kPositionKeyframes;
  if (static_cast<double>(graph.keyframes.size()) < solve_at) return;
  if (is_informative(graph.keyframes.back().positions.back())) solve(SolveReason::kGrowth);
}

/// True if a position is more certain than the newest keyframe or contradicts it.
bool SlamMap::is_informative(const AbsolutePosition& position) const {
  const Keyframe& now = graph.keyframes.back();
  const Eigen::Matrix2d known = now.covariance.topLeftCorner<2, 2>();
  if (known.trace() > position.covariance.trace()) return true;
  const Eigen::Vector2d off_m =
      position.p_map -
      transform(compose(now.T_map_base, position.T_keyframe_then), position.lever_base_m);
  const Eigen::Matrix2d S = known + position.covariance;
  return off_m.dot(S.inverse() * off_m) > kContradicts_sigma * kContradicts_sigma;
}

void SlamMap::georeference() {
  const std::optional<Eigen::Vector3d> T_map_graph = find_georeference(graph, kPlacementTravel_m);
  if (!T_map_graph) return;
  apply_georeference(*T_map_graph, graph);
  if (graph.keyframes.size() > 1 && solve(SolveReason::kGrowth)) return;
  // Until a whole solve computes covariances, use those of the absolute positions.
  for (Keyframe& k : graph.keyframes) {
    for (const AbsolutePosition& position : k.positions) {
      k.covariance.topLeftCorner<2, 2>() = position.covariance;
      k.covariance(2, 2) = position.yaw_sd_rad * position.yaw_sd_rad;
    }
  }
  rebuild_index();
}

SlamMap SlamUndo::light_copy(SlamMap& map) {
  std::vector<Keyframe> keyframes = std::move(map.graph.keyframes);
  std::vector<SlamLandmark> landmarks = std::move(map.graph.landmarks);
  map.graph.keyframes.clear();
  map.graph.landmarks.clear();
  SlamMap copy = map;
  map.graph.keyframes = std::move(keyframes);
  map.graph.landmarks = std::move(landmarks);
  return copy;
}

SlamUndo::SlamUndo(SlamMap& map) : map_(map), others_(light_copy(map)) {
  poses_.reserve(map.graph.keyframes.size());
  for (const Keyframe& k : map.graph.keyframes) {
    poses_.push_back({k.T_map_base, k.covariance, k.calibration_cross, k.calibration_covariance});
  }
  places_.reserve(map.graph.landmarks.size());
  for (const SlamLandmark& l : map.graph.landmarks) places_.push_back({l.p_map, l.information});
  map.graph.merges.emplace();
}

SlamUndo::~SlamUndo() { map_.graph.merges.reset(); }

void SlamUndo::restore() {
  SlamGraph& graph = map_.graph;
  graph.undo_merges();
  for (std::size_t k = 0; k < poses_.size(); ++k) {
    Keyframe& keyframe = graph.keyframes[k];
    keyframe.T_map_base = poses_[k].T_map_base;
    keyframe.covariance = poses_[k].covariance;
    keyframe.calibration_cross = poses_[k].calibration_cross;
    keyframe.calibration_covariance = poses_[k].calibration_covariance;
  }
  for (std::size_t l = 0; l < places_.size(); ++l) {
    graph.landmarks[l].p_map = places_[l].p_map;
    graph.landmarks[l].information = places_[l].information;
  }
  std::swap(others_.graph.keyframes, graph.keyframes);
  std::swap(others_.graph.landmarks, graph.landmarks);
  map_ = std::move(others_);
}

}  // namespace orchard::pose

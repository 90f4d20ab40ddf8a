// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/finish/finish.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "mapping/compare/map_merging.hpp"
#include "mapping/extent/extent.hpp"
#include "mapping/finish/heights.hpp"
#include "mapping/finish/plants.hpp"
#include "mapping/rows/hidden_trees.hpp"
#include "mapping/rows/row_numbers.hpp"

namespace orchard::mapping {
namespace {

using Ids = std::vector<std::int32_t>;  ///< in ascending order

/// Removes the landmarks with these ids, and notes the reason in `map`.
void omit(const Ids& ids, Omission reason, std::vector<Landmark>& landmarks, FinishedMap& map) {
  const auto is_omitted = [&](const Landmark& l) {
    return std::binary_search(ids.begin(), ids.end(), l.id);
  };
  for (const Landmark& l : landmarks) {
    if (is_omitted(l)) map.omitted.push_back({l.id, reason});
  }
  landmarks.erase(std::remove_if(landmarks.begin(), landmarks.end(), is_omitted), landmarks.end());
}

/// Notes those of `ids` that are no landmarks of the map.
void note_missing(const Ids& ids, const std::vector<Landmark>& landmarks, Omission reason,
                  FinishedMap& map) {
  std::set<std::int32_t> present;
  for (const Landmark& l : landmarks) present.insert(l.id);
  for (const std::int32_t id : ids) {
    if (present.count(id) == 0) map.omitted.push_back({id, reason});
  }
}

Ids ids_of(const std::vector<Landmark>& landmarks) {
  Ids ids;
  for (const Landmark& l : landmarks) ids.push_back(l.id);
  return ids;
}

void join_long(const MapperConfig& config, GroundOccupancy& ground,
               std::vector<Landmark>& landmarks) {
  const StemScatterTest stems(landmarks);
  const auto is_separate = [&](const Landmark& l) {
    const bool seen_as_tree = config.has_camera && l.label == detection::Label::kTree;
    return l.row > 0 || seen_as_tree || stems.contains(l);
  };
  const PassageTest passage = [&ground](const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                                        double half_depth_m, double clear_m) {
    return ground.passage(from, to, half_depth_m, clear_m);
  };
  landmarks = join_long_objects(
      std::move(landmarks), config.object_width_max_m, passage,
      [&ground](const Eigen::Vector2d& p_map) { return ground.is_free(p_map); }, is_separate);
}

/// Numbers and joins the landmarks that exist.
FinishedMap numbered(const Mapper& mapper, const MapperConfig& config,
                     std::vector<Landmark> standing, GroundOccupancy& ground) {
  FinishedMap map;
  map.landmarks = std::move(standing);
  number_landmarks(find_rows(map.landmarks, config.rows), map.landmarks);
  const Ids apart = ids_of(map.landmarks);
  join_long(config, ground, map.landmarks);
  std::vector<Landmark> plants =
      join_plants(map.landmarks, config.rows,
                  [&mapper](const Landmark& stem, const std::vector<std::int32_t>& trees) {
                    return mapper.common_place(stem, trees);
                  });
  if (plants.size() != map.landmarks.size()) {
    map.landmarks = std::move(plants);
    number_landmarks(find_rows(map.landmarks, config.rows), map.landmarks);
  }
  number_trunks_in_gaps(map.landmarks);
  if (config.judges_by_width()) map.hidden_tree_ids = name_trees_in_gaps(map.landmarks);
  note_missing(apart, map.landmarks, Omission::kPart, map);
  return map;
}

void forget_widths_of_foliage(FinishedMap& map) {
  for (Landmark& l : map.landmarks) {
    const Ids& hidden = map.hidden_tree_ids;
    if (std::binary_search(hidden.begin(), hidden.end(), l.id)) l.width_m = l.width_sd_m = 0.0;
  }
}

FinishedMap finish_on(const Mapper& mapper, GroundOccupancy& ground,
                      const pose::GroundProfile& heights) {
  const MapperConfig& config = mapper.config();
  std::vector<Landmark> standing = mapper.landmarks(config.min_observations);
  FinishedMap early;
  note_missing(mapper.ids_from(1, mapper.num_landmarks()), standing, Omission::kFewObservations,
               early);
  omit(mapper.spurious_ids(ground), Omission::kSpurious, standing, early);
  FinishedMap map = numbered(mapper, config, std::move(standing), ground);
  map.omitted.insert(map.omitted.end(), early.omitted.begin(), early.omitted.end());
  std::sort(map.omitted.begin(), map.omitted.end(),
            [](const OmittedLandmark& a, const OmittedLandmark& b) { return a.id < b.id; });
  map.rows = numbered_rows(map.landmarks);
  if (config.judges_by_width()) set_probability_by_order(map.rows, map.landmarks);
  set_heights(heights, map.landmarks);
  return map;
}

}  // namespace

std::size_t FinishedMap::num_omitted(Omission reason) const {
  return static_cast<std::size_t>(
      std::count_if(omitted.begin(), omitted.end(),
                    [reason](const OmittedLandmark& l) { return l.reason == reason; }));
}

FinishedMap finish(const Mapper& mapper, const pose::GroundProfile& heights) {
  const std::shared_ptr<GroundOccupancy> ground = mapper.ground();
  FinishedMap map = finish_on(mapper, *ground, heights);
  map.graph = navigation_graph_of(map.landmarks, map.rows, *ground);
  forget_widths_of_foliage(map);  // which narrows the ways all the same
  return map;
}

FinishedMap finish_without_ways(const Mapper& mapper, const pose::GroundProfile& heights) {
  FinishedMap map = finish_on(mapper, *mapper.ground(), heights);
  forget_widths_of_foliage(map);
  return map;
}

NavigationGraph navigation_graph_of(const std::vector<Landmark>& landmarks,
                                    const std::vector<Row>& rows, GroundOccupancy& ground) {
  return navigation_graph(
      landmarks, rows, [&ground](const Eigen::Vector2d& p_map) { return ground.is_free(p_map); });
}

void number_merged(const RowsConfig& config, std::vector<Landmark>& landmarks) {
  if (!config.has_rows()) return;
  const std::vector<Landmark> known = landmarks;
  const std::vector<Row> rows = find_rows(landmarks, config);
  const bool has_numbers =
      std::any_of(known.begin(), known.end(), [](const Landmark& l) { return l.row != 0; });
  if (!has_numbers) return number_landmarks(rows, landmarks);
  IdTransfer kept;
  keep_numbers(known, rows, landmarks, kept);
}

}  // namespace orchard::mapping

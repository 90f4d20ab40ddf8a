// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/old_keys.hpp"

#include <string_view>

namespace orchard::io {

const std::vector<OldKey>& old_keys() {
  static const std::vector<OldKey> keys{
      {"detector.consistency", "extrinsics_monitor"},
      {"detector.segmentation.bridge_beams", "merge_occluded_beams"},
      {"detector.visible_min", "visible_fraction_min"},
      {"mapper.apart_m", "split_distance_m"},
      {"mapper.presence", "existence"},
      {"mapper.range_use_max_m", "observation_range_max_m"},
      {"mapper.sweep_pose_gap_max_s", "deskew_pose_gap_max_s"},
      {"pose.prior_map.sighting_range_max_m", "observation_range_max_m"},
      {"pose.prior_map.sighting_sd_m", "observation_sd_m"},
      {"pose.prior_map.sure_range_m", "detection_range_m"},
      {"pose.slam.sight_range_max_m", "observation_range_max_m"},
      {"pose.slam.sighting_sd_m", "observation_sd_m"},
      {"pose.slam.sighting_share_min", "detection_rate_min"},
      {"pose.slam.solve_stretch_m", "submap_length_m"},
      {"simulation.light.sun_share", "sun_fraction"},
      {"mapper.save_period_s", nullptr, "1"},
      {"pose.slam.closure_min_trees", nullptr},
      {"pose.slam.merge_m", nullptr},
      {"pose.scan_motion.search_turn_rad", nullptr},
      {"pose.scan_motion.thin_m", nullptr, "0.1"},
      {"pose.scan_motion.points_min", nullptr, "20"},
      {"pose.scan_motion.map_travel_m", nullptr, "15"},
      {"pose.scan_motion.score_reliable", nullptr, "0.35"},
      {"pose.scan_motion.reliable_shift_sd_m", nullptr, "0.1"},
      {"pose.scan_motion.reliable_turn_sd_rad", nullptr, "0.03"},
      {"pose.scan_motion.normal_radius_m", nullptr, "0.3"},
      {"pose.scan_motion.flatness_max", nullptr, "0.05"},
      {"pose.scan_motion.map_radius_m", nullptr, "50"},
      {"pose.scan_motion.map_spacing_m", nullptr, "0.07"},
      {"pose.scan_motion.map_cell_points_max", nullptr, "16"},
      {"pose.scan_motion.map_cell_m", nullptr, "0.4"},
      {"pose.scan_motion.pair_max_m", nullptr, "0.6"},
      {"pose.scan_motion.pair_fine_m", nullptr, "0.25"},
      {"pose.scan_motion.kernel_m", nullptr, "0.3"},
      {"pose.scan_motion.kernel_fine_m", nullptr, "0.1"},
      {"pose.scan_motion.iterations_max", nullptr, "25"},
      {"pose.scan_motion.score_good", nullptr, "0.75"},
      {"pose.scan_motion.score_advantage", nullptr, "0.05"},
      {"pose.scan_motion.search_candidates", nullptr, "6"},
      {"pose.scan_motion.score_kernel_m", nullptr, "0.15"},
      {"pose.scan_motion.residual_sd_m", nullptr, "0.02"},
      {"pose.scan_motion.correlated_points", nullptr, "4"},
      {"pose.scan_motion.unknown_shift_sd_m", nullptr, "0.5"},
      {"pose.scan_motion.unknown_turn_sd_rad", nullptr, "0.3"},
      {"pose.fusion.curvature_sd_per_m", nullptr, "0.02"},
      {"pose.fusion.gyro_bias_sd_radps", nullptr, "0.02"},
      {"pose.fusion.scale_walk_per_sqrt_m", nullptr, "0.0001"},
      {"pose.fusion.gyro_walk_radps_per_sqrt_s", nullptr, "1e-05"},
      {"pose.fusion.noise_time_s", nullptr, "0.1"},
      {"pose.fusion.silence_speed_mps", nullptr, "1.5"},
      {"pose.fusion.silence_yaw_rate_radps", nullptr, "0.5"},
      {"pose.fusion.warn_sd_m", nullptr, "0.5"},
      {"pose.gnss.gate_sigma", nullptr, "4"},
      {"pose.gnss.believe_again_s", nullptr, "20"},
      {"pose.gnss.freeze_travel_m", nullptr, "0.5"},
      {"pose.prior_map.change_fraction", nullptr, "0.05"},
      {"pose.prior_map.drift_sd_m", nullptr, "0.01"},
      {"pose.prior_map.search_every_m", nullptr, "1"},
      {"pose.prior_map.min_trunks", nullptr, "6"},
      {"pose.prior_map.pair_max_m", nullptr, "8"},
      {"pose.prior_map.hypotheses_per_scan", nullptr, "400"},
      {"pose.prior_map.min_log_odds", nullptr, "9"},
      {"pose.prior_map.min_log_fit", nullptr, "0"},
      {"pose.prior_map.lost_log_fit", nullptr, "4"},
      {"pose.prior_map.lost_share", nullptr, "0.5"},
      {"pose.prior_map.lost_sd_m", nullptr, "1"},
      {"detector.adaptation.window_s", nullptr, "40"},
      {"detector.adaptation.window_trees", nullptr, "12"},
      {"detector.adaptation.teach_laser", nullptr, "0.3"},
      {"detector.adaptation.teach_vision", nullptr, "0.55"},
      {"detector.adaptation.teach_colour", nullptr, "0.1"},
      {"detector.adaptation.colour_gate", nullptr, "0.3"},
      {"detector.adaptation.agreement_min", nullptr, "0.2"},
      {"detector.adaptation.collapse_fraction", nullptr, "0.5"},
      {"detector.adaptation.separation_max", nullptr, "4"},
      {"detector.extrinsics_monitor.look_period_s", nullptr, "0.5"},
      {"detector.extrinsics_monitor.window_s", nullptr, "20"},
      {"detector.extrinsics_monitor.min_looks", nullptr, "20"},
      {"detector.extrinsics_monitor.warn_deg", nullptr, "0.75"},
      {"detector.extrinsics_monitor.clear_deg", nullptr, "0.5"},
      {"detector.extrinsics_monitor.reach_deg", nullptr, "4"},
      {"detector.edges.inlier_px", nullptr, "1"},
      {"detector.edges.parallel_tolerance_deg", nullptr, "10"},
      {"mapper.rows.min_trees", nullptr, "3"},
      {"mapper.rows.gap_max_spacings", nullptr, "8"},
      {"pose.slam.keyframe_turn_rad", nullptr, "0.3"},
      {"pose.slam.confirm_keyframes", nullptr, "3"},
      {"pose.slam.confirm_travel_m", nullptr, "1"},
      {"pose.slam.calibration_travel_m", nullptr, "50"},
      {"pose.slam.place_travel_m", nullptr, "5"},
      {"pose.slam.place_sd_min_m", nullptr, "0.02"},
      {"pose.slam.solve_growth", nullptr, "0.1"},
      {"pose.slam.solve_keyframes", nullptr, "500"},
      {"pose.slam.final_keyframes", nullptr, "5000"},
      {"pose.slam.sighting_sd_widths", nullptr, "0.1"},
      {"pose.slam.occluded_sd_widths", nullptr, "0.25"},
      {"pose.slam.object_sd_m", nullptr, "0.05"},
      {"pose.slam.outlier_sigma", nullptr, "3"},
      {"pose.slam.calibration_walk_fraction", nullptr, "0.1"},
      {"pose.slam.gap_speed_sd_mps", nullptr, "0.5"},
      {"pose.slam.gap_yaw_rate_sd_radps", nullptr, "0.3"},
      {"pose.slam.recent_travel_m", nullptr, "20"},
      {"pose.slam.covisible_travel_m", nullptr, "8"},
      {"pose.slam.closure_stretch_m", nullptr, "25"},
      {"pose.slam.closure_every_m", nullptr, "2"},
      {"pose.slam.closure_search_max_m", nullptr, "15"},
      {"mapper.well_known_observations", nullptr, "30"},
      {"mapper.tree_rate_of_trees", nullptr, "0.8"},
      {"mapper.tree_rate_of_objects", nullptr, "0.2"},
      {"mapper.rederive_m", nullptr, "0.02"},
      {"mapper.refresh_period_s", nullptr, "2"},
      {"mapper.refresh_per_s", nullptr, "200"},
      {"mapper.existence.past_rate", nullptr, "0.1"},
      {"mapper.existence.past_rate_gone", nullptr, "0.7"},
      {"mapper.existence.past_beams", nullptr, "6"},
      {"mapper.existence.beam_log_odds_max", nullptr, "8"},
      {"mapper.existence.log_odds_gone", nullptr, "-2"},
      {"mapper.existence.past_sigmas", nullptr, "2"},
      {"mapper.existence.past_share", nullptr, "0.8"},
      {"mapper.existence.beam_reach_m", nullptr, "8"},
      {"mapper.existence.sure_range_m", nullptr},
      {"mapper.existence.seen_rate", nullptr},
      {"mapper.existence.stray_rate", nullptr},
      {"mapper.existence.log_odds_max", nullptr},
  };
  return keys;
}

std::vector<std::string> former_names(const std::string& path) {
  const std::size_t begin = path.rfind('.') + 1;  // 0 if there is no dot
  std::vector<std::string> names;
  for (const OldKey& old : old_keys()) {
    const std::string_view old_path(old.path);
    if (old.name == nullptr || path.compare(begin, std::string::npos, old.name) != 0) continue;
    if (old_path.substr(0, begin) != std::string_view(path).substr(0, begin)) continue;
    if (old_path.find('.', begin) != std::string_view::npos) continue;
    names.emplace_back(old_path.substr(begin));
  }
  return names;
}

const OldKey* find_fixed_key(const std::string& path) {
  for (const OldKey& old : old_keys()) {
    if (old.name == nullptr && path == old.path) return &old;
  }
  return nullptr;
}

}  // namespace orchard::io

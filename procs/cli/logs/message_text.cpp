// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/message_text.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace orchard::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kWordsOfArray = 8;

const char* label_name(detection::Label label) {
  switch (label) {
    case detection::Label::kTree:
      return "tree";
    case detection::Label::kObject:
      return "object";
    default:
      return "unseen";
  }
}

Json fields(const laser::Scan& m) {
  return {{"bearing_min_rad", m.bearing_min_rad}, {"bearing_step_rad", m.bearing_step_rad},
          {"beam_period_us", m.beam_period_us},   {"range_min_m", m.range_min_m},
          {"range_max_m", m.range_max_m},         {"ranges_m", m.ranges_m},
          {"intensities", m.intensities}};
}

Json fields(const vision::Image& m) {
  constexpr const char* kEncodings[] = {"JPEG", "BGR8", "GRAY8"};
  return {{"width_px", m.width_px},
          {"height_px", m.height_px},
          {"encoding", kEncodings[static_cast<int>(m.encoding)]},
          {"num_bytes", m.data.size()}};
}

Json fields(const pose::Odometry& m) {
  return {{"speed_mps", m.speed_mps},
          {"yaw_rate_radps", m.yaw_rate_radps},
          {"covariance", m.covariance}};
}

Json fields(const pose::Gnss& m) {
  return {{"latitude_deg", m.latitude_deg},
          {"longitude_deg", m.longitude_deg},
          {"altitude_m", m.altitude_m},
          {"covariance", m.covariance},
          {"fix_quality", m.fix_quality}};
}

Json fields(const pose::PoseFix& m) {
  return {{"x_m", m.x_m},
          {"y_m", m.y_m},
          {"yaw_rad", m.yaw_rad},
          {"covariance", m.covariance},
          {"has_yaw", m.has_yaw}};
}

Json fields(const pose::PoseEstimate& m) {
  return {{"x_m", m.x_m},           {"y_m", m.y_m},
          {"yaw_rad", m.yaw_rad},   {"pitch_rad", m.pitch_rad},
          {"roll_rad", m.roll_rad}, {"covariance", m.covariance}};
}

Json fields(const detection::Detections& m) {
  Json trunks = Json::array();
  for (const detection::Detection& t : m.trunks) {
    trunks.push_back({{"utime", t.utime},
                      {"label", label_name(t.label)},
                      {"range_m", t.range_m},
                      {"bearing_rad", t.bearing_rad},
                      {"surface_x_m", t.surface_x_m},
                      {"surface_y_m", t.surface_y_m},
                      {"centre_x_m", t.centre_x_m},
                      {"centre_y_m", t.centre_y_m},
                      {"covariance", t.covariance},
                      {"width_m", t.width_m},
                      {"width_sd_m", t.width_sd_m},
                      {"roc_laser", t.roc_laser},
                      {"roc_colour", t.roc_colour},
                      {"roc_left_edge", t.roc_left_edge},
                      {"roc_right_edge", t.roc_right_edge},
                      {"roc_parallel", t.roc_parallel},
                      {"roc_edges", t.roc_edges},
                      {"roc_vision", t.roc_vision},
                      {"roc_tree", t.roc_tree},
                      {"probability_tree", t.probability_tree},
                      {"probability_object", t.probability_object},
                      {"intensity", t.intensity},
                      {"num_beams", t.num_beams},
                      {"occlusion", t.occlusion}});
  }
  return {{"image_utime", m.image_utime}, {"num_trunks", m.trunks.size()}, {"trunks", trunks}};
}

Json fields(const mapping::MapTile& m) {
  Json landmarks = Json::array();
  for (const mapping::Landmark& l : m.landmarks) {
    landmarks.push_back({{"id", l.id},
                         {"label", label_name(l.label)},
                         {"num_observations", l.num_observations},
                         {"x_m", l.x_m},
                         {"y_m", l.y_m},
                         {"se_x_m", l.se_x_m},
                         {"se_y_m", l.se_y_m},
                         {"covariance", l.covariance},
                         {"width_m", l.width_m},
                         {"roc_mean", l.roc_mean},
                         {"probability", l.probability},
                         {"row", l.row},
                         {"position", l.position}});
  }
  return {{"num_landmarks_total", m.num_landmarks_total},
          {"num_landmarks", m.landmarks.size()},
          {"landmarks", landmarks},
          {"removed_ids", m.removed_ids}};
}

Json fields(const detection::AdaptationStep& m) {
  constexpr const char* kActions[] = {"", "step", "freeze", "resume", "rollback", "reset"};
  constexpr const char* kReasons[] = {"", "too few trees", "sensors disagree", "two populations",
                                      "confidence collapsed"};
  return {{"action", kActions[static_cast<int>(m.action)]},
          {"reason", kReasons[static_cast<int>(m.reason)]},
          {"num_width_trees", m.num_width_trees},
          {"num_colour_trees", m.num_colour_trees},
          {"confident_share", m.confident_share},
          {"width_mean_m", m.model.width_mean_m},
          {"light_blue", m.model.light.blue},
          {"light_red", m.model.light.red},
          {"light_green", m.model.light.green}};
}

Json fields(const pose::Imu& m) {
  Json json = {{"angular_rate_radps", m.angular_rate_radps},
               {"acceleration_mps2", m.acceleration_mps2},
               {"angular_rate_variance", m.angular_rate_variance},
               {"acceleration_variance", m.acceleration_variance}};
  if (m.has_orientation) {
    json.update({{"roll_rad", m.roll_rad},
                 {"pitch_rad", m.pitch_rad},
                 {"yaw_rad", m.yaw_rad},
                 {"orientation_variance", m.orientation_variance}});
  }
  return json;
}

Json fields(const pose::TrajectoryPage& m) {
  Json poses = Json::array();
  for (const pose::PoseEstimate& p : m.poses) {
    poses.push_back({{"utime", p.utime},
                     {"x_m", p.x_m},
                     {"y_m", p.y_m},
                     {"yaw_rad", p.yaw_rad},
                     {"covariance", p.covariance}});
  }
  return {{"revision", m.revision},
          {"page", m.page},
          {"num_pages", m.num_pages},
          {"num_poses", m.poses.size()},
          {"poses", poses}};
}

/// One value in words: numbers short, arrays with their beginning only, objects in braces.
std::string words(const Json& value) {
  if (value.is_number_float()) {
    return fmt::format("{:.6g}", value.get<double>());
  }
  if (value.is_object()) {
    std::string text;
    for (const auto& [key, field] : value.items()) {
      text += (text.empty() ? "" : " ") + key + "=" + words(field);
    }
    return "{" + text + "}";
  }
  if (!value.is_array()) return value.dump();
  std::string text;
  for (std::size_t i = 0; i < value.size() && i < kWordsOfArray; ++i) {
    text += (i == 0 ? "" : " ") + words(value[i]);
  }
  if (value.size() > kWordsOfArray) text += " ... " + std::to_string(value.size()) + " in all";
  return "[" + text + "]";
}

std::string line(const Json& all, bool json) {
  // Strings from the network may be no UTF-8.
  if (json) return all.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string text;
  for (const auto& [key, field] : all.items()) {
    const bool is_text = field.is_string();
    text += (text.empty() ? "" : " ") + key + "=" +
            (is_text ? field.dump(-1, ' ', false, Json::error_handler_t::replace) : words(field));
  }
  return text;
}

std::string with_stamp(std::int64_t utime, std::int32_t seq, const Json& rest, bool json) {
  Json all = {{"utime", utime}, {"seq", seq}};
  all.update(rest);
  return line(all, json);
}

}  // namespace

std::string message_text(const bus::Message& message, bool json) {
  return std::visit([json](const auto& m) { return with_stamp(m.utime, m.seq, fields(m), json); },
                    message);
}

std::string message_text(const bus::Status& m, bool json) {
  constexpr const char* kLevels[] = {"ok", "waiting", "warning", "error"};
  return with_stamp(m.utime, m.seq,
                    {{"name", m.name},
                     {"host", m.host},
                     {"level", kLevels[static_cast<int>(m.level)]},
                     {"num_good", m.num_good},
                     {"num_bad", m.num_bad},
                     {"num_lost", m.num_lost},
                     {"num_late", m.num_late},
                     {"num_duplicate", m.num_duplicate},
                     {"num_published", m.num_published},
                     {"input_period_s", m.input_period_s},
                     {"latency_mean_s", m.latency_mean_s},
                     {"latency_max_s", m.latency_max_s},
                     {"text", m.text}},
                    json);
}

std::string message_text(const bus::ConfigNotice& m, bool json) {
  return with_stamp(m.utime, m.seq,
                    {{"name", m.name}, {"version", m.version}, {"hash", m.hash}, {"text", m.text}},
                    json);
}

std::string message_text(const bus::Ack& m, bool json) {
  Json outputs = Json::array();
  for (const bus::OutputId& output : m.outputs) {
    outputs.push_back({{"channel", bus::info(output.channel).name}, {"seq", output.seq}});
  }
  return with_stamp(
      m.utime, m.seq,
      {{"node", m.node}, {"channel", bus::info(m.channel).name}, {"outputs", outputs}}, json);
}

std::string message_text(const bus::ReplayMark& m, bool json) {
  return with_stamp(m.utime, m.seq, {{"command", m.end ? "END" : "BEGIN"}}, json);
}

}  // namespace orchard::cli

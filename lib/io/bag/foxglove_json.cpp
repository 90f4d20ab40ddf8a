// SPDX-License-Identifier: BSD-3-Clause
#include "io/bag/foxglove_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "detection/detection.hpp"
#include "geometry/camera_model.hpp"
#include "text/encoded_text.hpp"

namespace orchard::io {
namespace {

using Json = nlohmann::json;

constexpr double kShownHeight_m = 1.5;  // of a trunk's cylinder: the map has no heights

Json time(std::int64_t utime) {
  return {{"sec", utime / 1'000'000}, {"nsec", utime % 1'000'000 * 1000}};
}
Json vector(double x, double y, double z) { return {{"x", x}, {"y", y}, {"z", z}}; }
Json unturned() { return {{"x", 0.0}, {"y", 0.0}, {"z", 0.0}, {"w", 1.0}}; }
Json turned(double yaw_rad) {
  return {{"x", 0.0}, {"y", 0.0}, {"z", std::sin(yaw_rad / 2)}, {"w", std::cos(yaw_rad / 2)}};
}
Json turned(const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond q(rotation);
  return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}};
}
Json place(double x, double y, double z = 0.0) {
  return {{"position", vector(x, y, z)}, {"orientation", unturned()}};
}
Json colour(double r, double g, double b, double a) {
  return {{"r", r}, {"g", g}, {"b", b}, {"a", a}};
}
/// Colours as in the figures: trees green, objects red, landmarks no camera saw grey.
Json colour(detection::Label label, double opacity) {
  if (label == detection::Label::kTree) return colour(0.13, 0.55, 0.13, opacity);
  if (label == detection::Label::kObject) return colour(0.8, 0.1, 0.1, opacity);
  return colour(0.5, 0.5, 0.5, opacity);
}

Json transform(std::int64_t utime, const char* parent, const char* child, const Json& translation,
               const Json& rotation) {
  return {{"timestamp", time(utime)},
          {"parent_frame_id", parent},
          {"child_frame_id", child},
          {"translation", translation},
          {"rotation", rotation}};
}

/// An empty entity; the schema requires an entry for every kind of shape.
Json entity(std::int64_t utime, const char* frame, const std::string& id) {
  Json shown{{"timestamp", time(utime)},
             {"frame_id", frame},
             {"id", id},
             {"lifetime", {{"sec", 0}, {"nsec", 0}}},
             {"frame_locked", true}};
  for (const char* shapes : {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines",
                             "triangles", "texts", "models"}) {
    shown[shapes] = Json::array();
  }
  return shown;
}

Json cylinder(double x_m, double y_m, double width_m, double height_m, const Json& paint) {
  return {{"pose", place(x_m, y_m, height_m / 2)},
          {"size", vector(width_m, width_m, height_m)},
          {"bottom_scale", 1.0},
          {"top_scale", 1.0},
          {"color", paint}};
}

Json tree(std::int64_t utime, const mapping::Landmark& landmark) {
  Json shown = entity(utime, "map", "landmark " + std::to_string(landmark.id));
  shown["cylinders"].push_back(cylinder(landmark.x_m, landmark.y_m,
                                        std::max(0.02, landmark.width_m), kShownHeight_m,
                                        colour(landmark.label, 0.9)));
  std::string words = std::to_string(landmark.id);
  if (landmark.row > 0) {
    words = std::to_string(landmark.row) + "." + std::to_string(landmark.position);
  }
  shown["texts"].push_back({{"pose", place(landmark.x_m, landmark.y_m, kShownHeight_m + 0.3)},
                            {"billboard", true},
                            {"font_size", 0.3},
                            {"scale_invariant", false},
                            {"color", colour(1, 1, 1, 1)},
                            {"text", words}});
  const auto tell = [&shown](const char* key, const std::string& value) {
    shown["metadata"].push_back({{"key", key}, {"value", value}});
  };
  tell("id", std::to_string(landmark.id));
  tell("class", label_text(landmark.label));
  tell("n", std::to_string(landmark.num_observations));
  tell("roc_mean", std::to_string(landmark.roc_mean));
  tell("probability", std::to_string(landmark.probability));
  tell("width_m", std::to_string(landmark.width_m));
  return shown;
}

/// Non-finite numbers become null, as JSON cannot express them.
std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string foxglove_json(const laser::Scan& scan, const char* frame) {
  Json ranges = Json::array();
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    ranges.push_back(scan.valid(i) ? scan.ranges_m[i] : 0.0f);
  }
  return text_of({{"timestamp", time(scan.utime)},
                  {"frame_id", frame},
                  {"pose", place(0, 0)},
                  {"start_angle", scan.bearing_min_rad},
                  {"end_angle", scan.bearing_rad(static_cast<double>(scan.ranges_m.size()) - 1)},
                  {"ranges", ranges},
                  {"intensities", scan.intensities}});
}

std::string foxglove_json(const vision::Image& image) {
  Json json{{"timestamp", time(image.utime)},
            {"frame_id", "camera"},
            {"data", base64_text(image.data.data(), image.data.size())}};
  if (image.encoding == vision::Encoding::kJpeg) {
    json["format"] = "jpeg";
  } else {
    const bool is_grey = image.encoding == vision::Encoding::kGray8;
    json["width"] = image.width_px;
    json["height"] = image.height_px;
    json["encoding"] = is_grey ? "mono8" : "bgr8";
    json["step"] = image.width_px * (is_grey ? 1 : 3);
  }
  return text_of(json);
}

std::string foxglove_json(const pose::Gnss& gnss) {
  constexpr int kUnknown = 0, kKnown = 3;
  const auto& c = gnss.covariance;
  const bool is_known = c[0] > 0.0 || c[3] > 0.0;
  return text_of({{"timestamp", time(gnss.utime)},
                  {"frame_id", "gnss"},
                  {"latitude", gnss.latitude_deg},
                  {"longitude", gnss.longitude_deg},
                  {"altitude", gnss.altitude_m},
                  {"position_covariance", {c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5]}},
                  {"position_covariance_type", is_known ? kKnown : kUnknown}});
}

std::string foxglove_json(const pose::PoseEstimate& pose) {
  Json where = place(pose.x_m, pose.y_m);
  where["orientation"] = turned(pose.yaw_rad);
  return text_of({{"timestamp", time(pose.utime)}, {"frame_id", "map"}, {"pose", where}});
}

std::string foxglove_transform(const pose::PoseEstimate& pose) {
  return text_of({{"transforms",
                   {transform(pose.utime, "map", "base", vector(pose.x_m, pose.y_m, 0),
                              turned(pose.yaw_rad))}}});
}

std::string foxglove_json(const pose::PoseFix& fix) {
  Json where = place(fix.x_m, fix.y_m);
  if (fix.has_yaw) where["orientation"] = turned(fix.yaw_rad);
  return text_of({{"timestamp", time(fix.utime)}, {"frame_id", "map"}, {"pose", where}});
}

std::string foxglove_json(const pose::Odometry& odometry) {
  return text_of({{"timestamp", time(odometry.utime)},
                  {"speed_mps", odometry.speed_mps},
                  {"yaw_rate_radps", odometry.yaw_rate_radps}});
}

std::string foxglove_json(const pose::Imu& imu) {
  const auto& rate = imu.angular_rate_radps;
  const auto& force = imu.acceleration_mps2;
  return text_of({{"timestamp", time(imu.utime)},
                  {"angular_rate_radps", vector(rate[0], rate[1], rate[2])},
                  {"acceleration_mps2", vector(force[0], force[1], force[2])}});
}

std::string foxglove_mounts(std::int64_t utime, const laser::LaserConfig& laser,
                            const geometry::CameraConfig& camera) {
  Json transforms = Json::array();
  transforms.push_back(transform(utime, "base", "laser",
                                 vector(laser.mount_x_m, laser.mount_y_m, 0),
                                 turned(laser.mount_yaw_rad)));
  if (camera.enabled) {
    const geometry::LaserToCamera to_camera(camera.extrinsics);
    const Eigen::Matrix3d rotation = to_camera.rotation().transpose();
    const Eigen::Vector3d p_laser = -(rotation * to_camera.translation_m());
    transforms.push_back(transform(
        utime, "laser", "camera", vector(p_laser.x(), p_laser.y(), p_laser.z()), turned(rotation)));
  }
  return text_of({{"transforms", transforms}});
}

std::string foxglove_calibration(std::int64_t utime, const geometry::CameraIntrinsics& camera) {
  const double fx = camera.fc_px[0], fy = camera.fc_px[1], cx = camera.cc_px[0],
               cy = camera.cc_px[1], skew = camera.alpha_c * fx;
  return text_of({{"timestamp", time(utime)},
                  {"frame_id", "camera"},
                  {"width", camera.width_px},
                  {"height", camera.height_px},
                  {"distortion_model", "plumb_bob"},
                  {"D", camera.kc},
                  {"K", {fx, skew, cx, 0.0, fy, cy, 0.0, 0.0, 1.0}},
                  {"R", {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}},
                  {"P", {fx, skew, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0}}});
}

std::string foxglove_scene(std::int64_t utime, const std::vector<mapping::Landmark>& landmarks,
                           const std::vector<std::int32_t>& removed_ids) {
  Json entities = Json::array(), deletions = Json::array();
  for (const mapping::Landmark& landmark : landmarks) entities.push_back(tree(utime, landmark));
  for (const std::int32_t id : removed_ids) {
    deletions.push_back(
        {{"timestamp", time(utime)}, {"type", 0}, {"id", "landmark " + std::to_string(id)}});
  }
  return text_of({{"deletions", deletions}, {"entities", entities}});
}

std::string foxglove_scene(const detection::Detections& detections) {
  Json shown = entity(detections.utime, "base", "detections");
  for (const detection::Detection& trunk : detections.trunks) {
    shown["cylinders"].push_back(cylinder(trunk.centre_x_m, trunk.centre_y_m,
                                          std::max(0.02, trunk.width_m), 0.3,
                                          colour(trunk.label, 0.5)));
  }
  return text_of({{"deletions", Json::array()}, {"entities", {shown}}});
}

std::string foxglove_path(std::int64_t utime, const std::vector<pose::PoseEstimate>& path) {
  constexpr int kStrip = 0;
  Json points = Json::array();
  for (const pose::PoseEstimate& pose : path) points.push_back(vector(pose.x_m, pose.y_m, 0.0));
  Json shown = entity(utime, "map", "path");
  shown["lines"].push_back({{"type", kStrip},
                            {"pose", place(0, 0)},
                            {"thickness", 2.0},
                            {"scale_invariant", true},
                            {"points", points},
                            {"color", colour(0.1, 0.3, 0.9, 1)},
                            {"colors", Json::array()},
                            {"indices", Json::array()}});
  return text_of({{"deletions", Json::array()}, {"entities", {shown}}});
}

}  // namespace orchard::io

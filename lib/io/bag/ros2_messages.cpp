// SPDX-License-Identifier: BSD-3-Clause
#include "io/bag/ros2_messages.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "ros/cdr_message.hpp"

namespace orchard::io {
namespace {

using Json = nlohmann::json;

constexpr double kShownHeight_m = 1.5;  // of a trunk's cylinder: the map has no heights

// Of visualization_msgs/Marker.
enum MarkerType { kCylinder = 3, kText = 9 };
enum MarkerAction { kAdd = 0, kDelete = 2, kDeleteAll = 3 };

Json header(std::int64_t utime, const char* frame) {
  return {{"stamp", {{"sec", utime / 1'000'000}, {"nanosec", utime % 1'000'000 * 1000}}},
          {"frame_id", frame}};
}
Json vector(double x, double y, double z = 0.0) { return {{"x", x}, {"y", y}, {"z", z}}; }
Json turned(double yaw_rad) { return {{"z", std::sin(yaw_rad / 2)}, {"w", std::cos(yaw_rad / 2)}}; }
Json turned(const Eigen::Quaterniond& q) {
  return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}};
}
Json pose_json(const Json& position, const Json& orientation = turned(0.0)) {
  return {{"position", position}, {"orientation", orientation}};
}
Json diagonal(double variance) { return {variance, 0, 0, 0, variance, 0, 0, 0, variance}; }

/// 6 x 6 of a pose, row by row, from (x, y, yaw).
Json covariance(const std::array<double, 6>& c) {
  Json full(std::vector<double>(36));
  full[0] = c[0], full[1] = full[6] = c[1], full[5] = full[30] = c[2];
  full[7] = c[3], full[11] = full[31] = c[4], full[35] = c[5];
  return full;
}

/// Colours as in the figures: trees green, objects red, landmarks no camera saw grey.
Json colour(detection::Label label, double opacity) {
  const auto rgba = [opacity](double r, double g, double b) {
    return Json{{"r", r}, {"g", g}, {"b", b}, {"a", opacity}};
  };
  if (label == detection::Label::kTree) return rgba(0.13, 0.55, 0.13);
  return label == detection::Label::kObject ? rgba(0.8, 0.1, 0.1) : rgba(0.5, 0.5, 0.5);
}

Json transform(std::int64_t utime, const char* parent, const char* child, const Json& translation,
               const Json& rotation) {
  return {{"header", header(utime, parent)},
          {"child_frame_id", child},
          {"transform", {{"translation", translation}, {"rotation", rotation}}}};
}

Json marker(const Json& header, const char* name, std::int64_t id, MarkerAction action) {
  return {{"header", header}, {"ns", name}, {"id", id}, {"action", action}};
}

Json cylinder(Json marker, double x_m, double y_m, double width_m, double height_m,
              const Json& paint) {
  constexpr double kVisible_m = 0.02;
  const double shown_m = std::max(kVisible_m, width_m);
  marker.update({{"type", kCylinder},
                 {"pose", pose_json(vector(x_m, y_m, height_m / 2))},
                 {"scale", vector(shown_m, shown_m, height_m)},
                 {"color", paint},
                 {"frame_locked", 1}});
  return marker;
}

Json number_of(const Json& header, const mapping::Landmark& landmark) {
  Json words = marker(header, "numbers", landmark.id, kAdd);
  words.update({{"type", kText},
                {"pose", pose_json(vector(landmark.x_m, landmark.y_m, kShownHeight_m + 0.3))},
                {"scale", vector(0.3, 0.3, 0.3)},
                {"color", {{"r", 1}, {"g", 1}, {"b", 1}, {"a", 1}}},
                {"text", landmark.row > 0 ? std::to_string(landmark.row) + "." +
                                                std::to_string(landmark.position)
                                          : std::to_string(landmark.id)}});
  return words;
}

Ros2Message made(const char* topic, const char* type, std::int64_t utime, const Json& fields) {
  return {topic, type, utime, ros::cdr_message(type, fields)};
}

Ros2Message scan_message(const laser::Scan& scan, const char* topic, const char* frame) {
  Json ranges = Json::array();
  for (const float range_m : scan.ranges_m) {
    ranges.push_back(range_m == 0.0f ? std::numeric_limits<float>::infinity() : range_m);
  }
  return made(topic, "sensor_msgs/msg/LaserScan", scan.utime,
              {{"header", header(scan.utime, frame)},
               {"angle_min", scan.bearing_min_rad},
               {"angle_max", scan.bearing_rad(static_cast<double>(scan.ranges_m.size()) - 1)},
               {"angle_increment", scan.bearing_step_rad},
               {"time_increment", 1e-6 * scan.beam_period_us},
               {"range_min", scan.range_min_m},
               {"range_max", scan.range_max_m},
               {"ranges", ranges},
               {"intensities", scan.intensities}});
}

}  // namespace

Ros2Message ros2_message(const laser::Scan& scan) { return scan_message(scan, "/scan", "laser"); }

Ros2Message ros2_message(const laser::RearScan& scan) {
  return scan_message(scan, "/scan_rear", "laser_rear");
}

Ros2Message ros2_message(const vision::Image& image) {
  Json fields{{"header", header(image.utime, "camera")}, {"data", Json::binary(image.data)}};
  if (image.encoding == vision::Encoding::kJpeg) {
    fields["format"] = "jpeg";
    return made("/camera/image_raw/compressed", "sensor_msgs/msg/CompressedImage", image.utime,
                fields);
  }
  const bool is_grey = image.encoding == vision::Encoding::kGray8;
  fields.update({{"height", image.height_px},
                 {"width", image.width_px},
                 {"encoding", is_grey ? "mono8" : "bgr8"},
                 {"step", image.width_px * (is_grey ? 1 : 3)}});
  return made("/camera/image_raw", "sensor_msgs/msg/Image", image.utime, fields);
}

Ros2Message ros2_message(const pose::Odometry& odometry) {
  const auto& c = odometry.covariance;
  return made("/odom", "nav_msgs/msg/Odometry", odometry.utime,
              {{"header", header(odometry.utime, "odom")},
               {"child_frame_id", "base"},
               {"pose", {{"pose", pose_json(vector(0, 0))}}},
               {"twist",
                {{"twist",
                  {{"linear", vector(odometry.speed_mps, 0)},
                   {"angular", vector(0, 0, odometry.yaw_rate_radps)}}},
                 {"covariance", covariance({c[0], 0.0, c[1], 0.0, 0.0, c[2]})}}}});
}

Ros2Message ros2_message(const pose::Imu& imu) {
  const auto& rate = imu.angular_rate_radps;
  const auto& force = imu.acceleration_mps2;
  const Eigen::Quaterniond q = Eigen::AngleAxisd(imu.yaw_rad, Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(imu.pitch_rad, Eigen::Vector3d::UnitY()) *
                               Eigen::AngleAxisd(imu.roll_rad, Eigen::Vector3d::UnitX());
  Json orientation_covariance = diagonal(imu.orientation_variance);
  if (!imu.has_orientation) orientation_covariance[0] = -1.0;  // not measured
  return made("/imu", "sensor_msgs/msg/Imu", imu.utime,
              {{"header", header(imu.utime, "base")},
               {"orientation", turned(q)},
               {"orientation_covariance", orientation_covariance},
               {"angular_velocity", vector(rate[0], rate[1], rate[2])},
               {"angular_velocity_covariance", diagonal(imu.angular_rate_variance)},
               {"linear_acceleration", vector(force[0], force[1], force[2])},
               {"linear_acceleration_covariance", diagonal(imu.acceleration_variance)}});
}

Ros2Message ros2_message(const pose::Gnss& gnss) {
  constexpr int kNoFix = -1, kFix = 0, kSatellites = 1, kGround = 2, kGps = 1, kKnown = 3;
  const auto& c = gnss.covariance;
  const int status = gnss.fix_quality == 0   ? kNoFix
                     : gnss.fix_quality == 1 ? kFix
                     : gnss.fix_quality == 2 ? kSatellites
                                             : kGround;
  return made("/gnss", "sensor_msgs/msg/NavSatFix", gnss.utime,
              {{"header", header(gnss.utime, "gnss")},
               {"status", {{"status", status}, {"service", kGps}}},
               {"latitude", gnss.latitude_deg},
               {"longitude", gnss.longitude_deg},
               {"altitude", gnss.altitude_m},
               {"position_covariance", {c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5]}},
               {"position_covariance_type", c[0] > 0.0 || c[3] > 0.0 ? kKnown : 0}});
}

Ros2Message ros2_message(const pose::PoseFix& fix) {
  // An orientation that was not measured is all zero.
  const Json place =
      pose_json(vector(fix.x_m, fix.y_m), fix.has_yaw ? turned(fix.yaw_rad) : Json::object());
  return made("/pose_fix", "geometry_msgs/msg/PoseWithCovarianceStamped", fix.utime,
              {{"header", header(fix.utime, "map")},
               {"pose", {{"pose", place}, {"covariance", covariance(fix.covariance)}}}});
}

Ros2Message ros2_message(const pose::PoseEstimate& pose) {
  return made(
      "/tf", "tf2_msgs/msg/TFMessage", pose.utime,
      {{"transforms",
        {transform(pose.utime, "map", "base", vector(pose.x_m, pose.y_m), turned(pose.yaw_rad))}}});
}

Ros2Message ros2_message(const detection::Detections& detections) {
  constexpr double kHeight_m = 0.3, kOpacity = 0.5;
  const Json stamped = header(detections.utime, "base");
  Json markers = Json::array({marker(stamped, "detections", 0, kDeleteAll)});
  for (const detection::Detection& trunk : detections.trunks) {
    markers.push_back(
        cylinder(marker(stamped, "detections", static_cast<std::int64_t>(markers.size()), kAdd),
                 trunk.centre_x_m, trunk.centre_y_m, trunk.width_m, kHeight_m,
                 colour(trunk.label, kOpacity)));
  }
  return made("/detections", "visualization_msgs/msg/MarkerArray", detections.utime,
              {{"markers", markers}});
}

Ros2Message ros2_mounts(std::int64_t utime, const laser::LaserConfig& laser,
                        const laser::RearLaserConfig& rear, const geometry::CameraConfig& camera,
                        const std::array<double, 2>& antenna_m) {
  const auto mounted = [utime](const char* frame, double x_m, double y_m, double yaw_rad) {
    return transform(utime, "base", frame, vector(x_m, y_m), turned(yaw_rad));
  };
  Json transforms =
      Json::array({mounted("laser", laser.mount_x_m, laser.mount_y_m, laser.mount_yaw_rad),
                   mounted("gnss", antenna_m[0], antenna_m[1], 0.0)});
  if (rear.enabled) {
    transforms.push_back(mounted("laser_rear", rear.mount_x_m, rear.mount_y_m, rear.mount_yaw_rad));
  }
  if (camera.enabled) {
    const geometry::LaserToCamera to_camera(camera.extrinsics);
    const Eigen::Matrix3d R_laser_camera = to_camera.rotation().transpose();
    const Eigen::Vector3d p_laser = -(R_laser_camera * to_camera.translation_m());
    transforms.push_back(transform(utime, "laser", "camera",
                                   vector(p_laser.x(), p_laser.y(), p_laser.z()),
                                   turned(Eigen::Quaterniond(R_laser_camera))));
  }
  return made("/tf_static", "tf2_msgs/msg/TFMessage", utime, {{"transforms", transforms}});
}

Ros2Message ros2_camera_info(std::int64_t utime, const geometry::CameraIntrinsics& camera) {
  const double fx = camera.fc_px[0], fy = camera.fc_px[1], cx = camera.cc_px[0],
               cy = camera.cc_px[1], skew = camera.alpha_c * fx;
  return made("/camera/camera_info", "sensor_msgs/msg/CameraInfo", utime,
              {{"header", header(utime, "camera")},
               {"height", camera.height_px},
               {"width", camera.width_px},
               {"distortion_model", "plumb_bob"},
               {"d", camera.kc},
               {"k", {fx, skew, cx, 0, fy, cy, 0, 0, 1}},
               {"r", {1, 0, 0, 0, 1, 0, 0, 0, 1}},
               {"p", {fx, skew, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0}}});
}

Ros2Message ros2_map(std::int64_t utime, const std::vector<mapping::Landmark>& landmarks,
                     const std::vector<std::int32_t>& removed_ids) {
  constexpr double kOpacity = 0.9;
  const Json stamped = header(utime, "map");
  Json markers = Json::array();
  for (const mapping::Landmark& landmark : landmarks) {
    markers.push_back(cylinder(marker(stamped, "landmarks", landmark.id, kAdd), landmark.x_m,
                               landmark.y_m, landmark.width_m, kShownHeight_m,
                               colour(landmark.label, kOpacity)));
    markers.push_back(number_of(stamped, landmark));
  }
  for (const std::int32_t id : removed_ids) {
    for (const char* name : {"landmarks", "numbers"}) {
      markers.push_back(marker(stamped, name, id, kDelete));
    }
  }
  return made("/map", "visualization_msgs/msg/MarkerArray", utime, {{"markers", markers}});
}

Ros2Message ros2_path(std::int64_t utime, const std::vector<pose::PoseEstimate>& path) {
  Json poses = Json::array();
  for (const pose::PoseEstimate& pose : path) {
    poses.push_back({{"header", header(pose.utime, "map")},
                     {"pose", pose_json(vector(pose.x_m, pose.y_m), turned(pose.yaw_rad))}});
  }
  return made("/map/path", "nav_msgs/msg/Path", utime,
              {{"header", header(utime, "map")}, {"poses", poses}});
}

}  // namespace orchard::io

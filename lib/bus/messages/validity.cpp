// SPDX-License-Identifier: BSD-3-Clause
#include "bus/messages/validity.hpp"

#include <cmath>
#include <string>

#include "bus/messages/jpeg_header.hpp"

namespace orchard::bus {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kFarM = 1e8;  // beyond any projected coordinate on Earth

/// Collects the first objection to a message; later checks are then without effect.
class Check {
 public:
  void finite(const char* name, double value) {
    if (!std::isfinite(value)) object(Reason::kNotFinite, name, value);
  }
  void within(const char* name, double value, double lo, double hi) {
    finite(name, value);
    if (!(value >= lo && value <= hi)) object(Reason::kOutOfRange, name, value);
  }
  void whole(const char* name, std::int64_t value, std::int64_t lo, std::int64_t hi) {
    if (value < lo || value > hi) {
      object(Reason::kOutOfRange, std::string(name) + " = " + std::to_string(value));
    }
  }
  void that(bool condition, Reason reason, const char* detail) {
    if (!condition) object(reason, detail);
  }
  void stamp(std::int64_t utime, std::int32_t seq) {
    whole("utime", utime, 0, kUtimeEnd - 1);
    whole("seq", seq, 0, INT32_MAX);
  }
  /// Upper triangle of a symmetric matrix, row by row; its diagonal stands at `diagonal`.
  template <std::size_t N, std::size_t D>
  void covariance(const std::array<double, N>& values, const std::array<std::size_t, D>& diagonal) {
    for (const double value : values) within("covariance", value, -1e12, 1e12);
    for (const std::size_t i : diagonal) within("covariance diagonal", values[i], 0, 1e12);
  }
  bool ok() const { return !rejection_; }
  std::optional<Rejection> result() && { return std::move(rejection_); }

 private:
  void object(Reason reason, std::string detail) {
    if (!rejection_) rejection_ = Rejection{reason, std::move(detail)};
  }
  void object(Reason reason, const char* name, double value) {
    object(reason, std::string(name) + " = " + std::to_string(value));
  }
  std::optional<Rejection> rejection_;
};

constexpr std::array<std::size_t, 2> kDiagonal2{0, 2};
constexpr std::array<std::size_t, 3> kDiagonal3{0, 3, 5};

void check(Check& c, const laser::Scan& scan) {
  c.within("bearing_min_rad", scan.bearing_min_rad, -4 * kPi, 4 * kPi);
  c.within("bearing_step_rad", scan.bearing_step_rad, -kPi, kPi);
  c.that(scan.bearing_step_rad != 0.0, Reason::kOutOfRange, "bearing_step_rad = 0");
  c.within("beam_period_us", scan.beam_period_us, 0, 1e7);
  c.within("range_min_m", scan.range_min_m, 0, 1e5);
  c.within("range_max_m", scan.range_max_m, 0, 1e5);
  c.that(scan.range_max_m > scan.range_min_m, Reason::kInconsistent,
         "range_max_m is not above range_min_m");
  c.that(!scan.ranges_m.empty(), Reason::kOutOfRange, "num_ranges = 0");
  if (!c.ok()) return;
  const double num_steps = static_cast<double>(scan.ranges_m.size()) - 1.0;
  c.that(num_steps * std::abs(scan.bearing_step_rad) <= 2 * kPi + 0.1, Reason::kInconsistent,
         "its beams cover more than one turn");
  c.that(scan.intensities.empty() || scan.intensities.size() == scan.ranges_m.size(),
         Reason::kInconsistent, "num_intensities is neither 0 nor num_ranges");
  // Scanners that speak ROS send +inf for no return and NaN or -inf for a beam that failed
  // (REP 117): every reader of ranges takes them for no return.
  for (const float range_m : scan.ranges_m) {
    const bool usual = range_m >= 0.0f && range_m <= 1e5f;
    if (!usual && std::isfinite(range_m)) c.within("ranges_m", range_m, 0, 1e5);
  }
  for (const float intensity : scan.intensities) {
    if (!std::isfinite(intensity)) c.finite("intensities", intensity);
  }
}

void check(Check& c, const vision::Image& image) {
  c.whole("width_px", image.width_px, 1, 16384);
  c.whole("height_px", image.height_px, 1, 16384);
  c.whole("encoding", static_cast<int>(image.encoding), 0, 2);
  if (!c.ok()) return;
  const std::size_t num_pixels = static_cast<std::size_t>(image.width_px) * image.height_px;
  if (image.encoding == vision::Encoding::kBgr8) {
    c.that(image.data.size() == 3 * num_pixels, Reason::kInconsistent,
           "num_bytes is not 3 x width_px x height_px");
  } else if (image.encoding == vision::Encoding::kGray8) {
    c.that(image.data.size() == num_pixels, Reason::kInconsistent,
           "num_bytes is not width_px x height_px");
  } else {
    const std::optional<JpegSize> size = find_jpeg_size(image.data);
    c.that(size.has_value(), Reason::kInconsistent, "no JPEG with a frame header");
    c.that(!size || (size->width_px == image.width_px && size->height_px == image.height_px),
           Reason::kInconsistent, "the JPEG's size is not width_px x height_px");
  }
}

void check(Check& c, const pose::Odometry& odometry) {
  c.within("speed_mps", odometry.speed_mps, -1000, 1000);
  c.within("yaw_rate_radps", odometry.yaw_rate_radps, -1000, 1000);
  c.covariance(odometry.covariance, kDiagonal2);
}

void check(Check& c, const pose::Gnss& gnss) {
  c.within("latitude_deg", gnss.latitude_deg, -90, 90);
  c.within("longitude_deg", gnss.longitude_deg, -180, 180);
  c.within("altitude_m", gnss.altitude_m, -12000, 100000);
  c.covariance(gnss.covariance, kDiagonal3);
  c.whole("fix_quality", gnss.fix_quality, 0, 9);
}

void check(Check& c, const pose::PoseFix& fix) {
  c.within("x_m", fix.x_m, -kFarM, kFarM);
  c.within("y_m", fix.y_m, -kFarM, kFarM);
  c.within("yaw_rad", fix.yaw_rad, -4 * kPi, 4 * kPi);
  c.covariance(fix.covariance, kDiagonal3);
}

void check(Check& c, const pose::PoseEstimate& pose) {
  c.within("x_m", pose.x_m, -kFarM, kFarM);
  c.within("y_m", pose.y_m, -kFarM, kFarM);
  c.within("yaw_rad", pose.yaw_rad, -kPi - 1e-9, kPi + 1e-9);
  c.within("pitch_rad", pose.pitch_rad, -kPi - 1e-9, kPi + 1e-9);
  c.within("roll_rad", pose.roll_rad, -kPi - 1e-9, kPi + 1e-9);
  c.covariance(pose.covariance, kDiagonal3);
}

void check(Check& c, const detection::Detections& detections) {
  c.whole("image_utime", detections.image_utime, 0, kUtimeEnd - 1);
  for (const detection::Detection& trunk : detections.trunks) {
    c.whole("trunk utime", trunk.utime, 0, kUtimeEnd - 1);
    c.within("range_m", trunk.range_m, 0, 1e5);
    c.within("bearing_rad", trunk.bearing_rad, -4 * kPi, 4 * kPi);
    c.within("surface_x_m", trunk.surface_x_m, -1e6, 1e6);
    c.within("surface_y_m", trunk.surface_y_m, -1e6, 1e6);
    c.within("centre_x_m", trunk.centre_x_m, -1e6, 1e6);
    c.within("centre_y_m", trunk.centre_y_m, -1e6, 1e6);
    c.covariance(trunk.covariance, kDiagonal2);
    c.within("width_m", trunk.width_m, 0, 1e5);
    c.within("width_sd_m", trunk.width_sd_m, 0, 1e5);
    c.within("roc_laser", trunk.roc_laser, 0, 1);
    c.within("roc_colour", trunk.roc_colour, 0, 1);
    c.within("roc_left_edge", trunk.roc_left_edge, 0, 1);
    c.within("roc_right_edge", trunk.roc_right_edge, 0, 1);
    c.within("roc_parallel", trunk.roc_parallel, 0, 1);
    c.within("roc_edges", trunk.roc_edges, 0, 1);
    c.within("roc_vision", trunk.roc_vision, 0, 1);
    c.within("roc_tree", trunk.roc_tree, 0, 1);
    c.within("probability_tree", trunk.probability_tree, 0, 1);
    c.within("probability_object", trunk.probability_object, 0, 1);
    // single precision: the two may add up to a little more than one
    c.within("probability_tree + probability_object",
             trunk.probability_tree + trunk.probability_object, 0, 1.0001);
    c.within("intensity", trunk.intensity, 0, 1e9);
    c.whole("num_beams", trunk.num_beams, 0, INT32_MAX);
    c.whole("label", static_cast<int>(trunk.label), 0, 2);
    c.whole("occlusion", trunk.occlusion, 0, 3);
    if (!c.ok()) return;
  }
}

void check(Check& c, const mapping::MapTile& tile) {
  c.whole("num_landmarks_total", tile.num_landmarks_total, 0, INT32_MAX);
  for (const mapping::Landmark& landmark : tile.landmarks) {
    c.whole("id", landmark.id, 0, INT32_MAX);
    c.whole("label", static_cast<int>(landmark.label), 0, 2);
    c.whole("num_observations", landmark.num_observations, 0, INT32_MAX);
    c.within("x_m", landmark.x_m, -kFarM, kFarM);
    c.within("y_m", landmark.y_m, -kFarM, kFarM);
    c.within("se_x_m", landmark.se_x_m, 0, kFarM);
    c.within("se_y_m", landmark.se_y_m, 0, kFarM);
    c.covariance(landmark.covariance, kDiagonal2);
    c.within("width_m", landmark.width_m, 0, 1e5);
    c.within("roc_mean", landmark.roc_mean, 0, 1);
    c.within("probability", landmark.probability, 0, 1);
    c.whole("row", landmark.row, 0, INT32_MAX);
    c.whole("position", landmark.position, 0, INT32_MAX);
    if (!c.ok()) return;
  }
  for (const std::int32_t id : tile.removed_ids) c.whole("removed_ids", id, 0, INT32_MAX);
}

void check(Check& c, const detection::AdaptationStep& step) {
  c.whole("action", static_cast<int>(step.action), 1, 5);
  c.whole("reason", static_cast<int>(step.reason), 0, 4);
  c.whole("num_width_trees", step.num_width_trees, 0, INT32_MAX);
  c.whole("num_colour_trees", step.num_colour_trees, 0, INT32_MAX);
  c.within("confident_share", step.confident_share, 0, 1);
  c.within("width_mean_m", step.model.width_mean_m, 0, 1e5);
  c.within("light_blue", step.model.light.blue, -10, 10);
  c.within("light_red", step.model.light.red, -10, 10);
  c.within("light_green", step.model.light.green, -10, 10);
}

void check(Check& c, const pose::Imu& imu) {
  for (const double rate : imu.angular_rate_radps) c.within("angular_rate_radps", rate, -1e3, 1e3);
  for (const double a : imu.acceleration_mps2) c.within("acceleration_mps2", a, -1e4, 1e4);
  c.within("angular_rate_variance", imu.angular_rate_variance, 0, 1e6);
  c.within("acceleration_variance", imu.acceleration_variance, 0, 1e8);
  c.within("roll_rad", imu.roll_rad, -4 * kPi, 4 * kPi);
  c.within("pitch_rad", imu.pitch_rad, -4 * kPi, 4 * kPi);
  c.within("yaw_rad", imu.yaw_rad, -4 * kPi, 4 * kPi);
  c.within("orientation_variance", imu.orientation_variance, 0, 1e3);
}

void check(Check& c, const pose::TrajectoryPage& page) {
  c.whole("revision", page.revision, 1, INT32_MAX);
  c.whole("num_pages", page.num_pages, 1, INT32_MAX);
  c.whole("page", page.page, 0, page.num_pages - 1);
  std::int64_t before = -1;
  for (const pose::PoseEstimate& pose : page.poses) {
    c.whole("pose utime", pose.utime, 0, kUtimeEnd - 1);
    c.that(pose.utime > before, Reason::kInconsistent, "its poses are not in order of utime");
    check(c, pose);
    if (!c.ok()) return;
    before = pose.utime;
  }
}

}  // namespace

std::optional<Rejection> check_content(const Message& message) {
  Check c;
  c.stamp(utime_of(message), seq_of(message));
  std::visit([&c](const auto& m) { check(c, m); }, message);
  return std::move(c).result();
}

}  // namespace orchard::bus

// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/observation_truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "geometry/angles.hpp"
#include "geometry/camera_model.hpp"
#include "worlds/angular_interval.hpp"

namespace orchard::simulation {
namespace {

/// Cross-section of a cylinder or box with the scan plane, relative to the laser's position; axes
/// of the map.
struct Outline {
  double x_m, y_m;       ///< of its middle
  double radius_m;       ///< of a circle; 0 for a rectangle
  double yaw_rad = 0.0;  ///< of a rectangle
  double half_length_m = 0.0, half_width_m = 0.0;
  int target = 0;
  double velocity_x_mps = 0.0, velocity_y_mps = 0.0;

  double reach_m() const {
    return radius_m > 0.0 ? radius_m : std::hypot(half_length_m, half_width_m);
  }

  /// Interval of directions that it covers, relative to `middle_rad`.
  AngularInterval interval(double middle_rad) const {
    const double to_rad = geometry::wrap_angle_rad(std::atan2(y_m, x_m) - middle_rad);
    const double distance_m = std::hypot(x_m, y_m);
    if (radius_m > 0.0) {
      const double half_rad =
          distance_m > radius_m ? std::asin(radius_m / distance_m) : geometry::kPi;
      return {to_rad - half_rad, to_rad + half_rad};
    }
    AngularInterval result{to_rad, to_rad};
    for (const std::array<double, 2>& corner : corners()) {
      const double off_rad =
          geometry::wrap_angle_rad(std::atan2(corner[1], corner[0]) - middle_rad - to_rad);
      result.low_rad = std::min(result.low_rad, to_rad + off_rad);
      result.high_rad = std::max(result.high_rad, to_rad + off_rad);
    }
    return result;
  }

  /// Distance to its surface in a direction that it covers [m].
  double range_m(double direction_rad) const {
    const double distance_m = std::hypot(x_m, y_m);
    if (radius_m > 0.0) {
      // law of sines: the angle at the surface is the obtuse one
      const double a_rad = direction_rad - std::atan2(y_m, x_m);
      const double sine = std::clamp(distance_m * std::sin(a_rad) / radius_m, -1.0, 1.0);
      return distance_m * std::cos(a_rad) - radius_m * std::cos(std::asin(sine));
    }
    // the nearest crossing with one of the four sides
    double nearest_m = std::numeric_limits<double>::infinity();
    const auto c = corners();
    const double dx = std::cos(direction_rad), dy = std::sin(direction_rad);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto& a = c[i];
      const auto& b = c[(i + 1) % 4];
      const double across_a = dx * a[1] - dy * a[0], across_b = dx * b[1] - dy * b[0];
      if (across_a == across_b || (across_a > 0.0) == (across_b > 0.0)) continue;
      const double fraction = across_a / (across_a - across_b);
      const double along_m =
          dx * (a[0] + fraction * (b[0] - a[0])) + dy * (a[1] + fraction * (b[1] - a[1]));
      if (along_m > 0.0) nearest_m = std::min(nearest_m, along_m);
    }
    return std::isfinite(nearest_m) ? nearest_m : distance_m;
  }

  std::array<std::array<double, 2>, 4> corners() const {
    const Pose2 T_map_box{x_m, y_m, yaw_rad};
    std::array<std::array<double, 2>, 4> result{};
    constexpr std::array<std::array<double, 2>, 4> kSigns{{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector2d corner =
          transform(T_map_box, {kSigns[i][0] * half_length_m, kSigns[i][1] * half_width_m});
      result[i] = {corner.x(), corner.y()};
    }
    return result;
  }
};

class TruthObserver {
 public:
  TruthObserver(const World& world, const std::vector<Pose2>& T_map_laser,
                const ScannerConfig& scanner, const geometry::CameraConfig& camera,
                const Tilt& tilt)
      : poses_(T_map_laser),
        scanner_(scanner),
        tilt_(tilt),
        has_camera_(camera.enabled),
        camera_(camera.intrinsics),
        T_camera_laser_(camera.extrinsics) {
    const double z_m = scanner.height_m;
    const auto in_plane = [z_m](const auto& shape) {
      return z_m >= shape.base_m && z_m <= shape.base_m + shape.height_m;
    };
    for (const Cylinder& c : world.cylinders) {
      if (in_plane(c))
        shapes_.push_back({c.x_m, c.y_m, c.radius_m, 0.0, 0.0, 0.0, c.target, c.velocity_x_mps,
                           c.velocity_y_mps});
    }
    for (const Box& b : world.boxes) {
      if (in_plane(b)) {
        shapes_.push_back(
            {b.x_m, b.y_m, 0.0, b.yaw_rad, 0.5 * b.length_m, 0.5 * b.width_m, b.target, 0.0, 0.0});
      }
    }
  }

  /// True if truth[index] is observable in the scan; fills `seen`.
  bool observe(int index, const TruthObject& thing, TrueObservation& seen) {
    const Passing passing = passing_over(thing);
    const Pose2& pose = passing.pose;
    seen.x_m = thing.x_m + thing.velocity_x_mps * passing.time_s;
    seen.y_m = thing.y_m + thing.velocity_y_mps * passing.time_s;
    const double dx = seen.x_m - pose.x_m, dy = seen.y_m - pose.y_m;
    const double middle_rad = std::atan2(dy, dx);
    const double distance_m = std::hypot(dx, dy);
    if (distance_m - thing.width_m > 1.5 * scanner_.range_max_m) return false;
    const AngularInterval view = field_of_view(middle_rad - pose.yaw_rad);
    gather(index, passing, middle_rad, view);
    std::vector<AngularInterval> own;
    for (const Piece& piece : own_) own.push_back(piece.interval);
    own = united(std::move(own));
    const double width_rad = total_width_rad(own);
    if (own.empty() || width_rad < scanner_.bearing_step_rad) return false;

    seen.object = index;
    seen.label = thing.label;
    seen.width_m = thing.width_m;
    seen.range_m = distance_m - 0.5 * thing.width_m;
    seen.bearing_rad = geometry::wrap_angle_rad(middle_rad - pose.yaw_rad);

    std::vector<AngularInterval> visible;
    for (const Piece& piece : own_) {
      for (const AngularInterval& part : visible_parts(piece, middle_rad)) visible.push_back(part);
    }
    visible = united(std::move(visible));
    seen.hidden_fraction = std::clamp(1.0 - total_width_rad(visible) / width_rad, 0.0, 1.0);
    if (ground_m(seen.bearing_rad) < seen.range_m) seen.hidden_fraction = 1.0;
    seen.num_beams = count_beams(visible, middle_rad, pose.yaw_rad);
    seen.in_picture = in_picture(own, distance_m, middle_rad - pose.yaw_rad);
    return true;
  }

 private:
  struct Piece {
    Outline outline;
    AngularInterval interval;
  };

  /// Time and pose at which the scanner's beam passes over the object's centre.
  struct Passing {
    Pose2 pose;
    double time_s = 0.0;  ///< from the middle of the sweep
  };

  Passing passing_over(const TruthObject& thing) const {
    Passing passing{poses_[poses_.size() / 2], 0.0};
    for (int i = 0; i < 3; ++i) {
      const double x_m = thing.x_m + thing.velocity_x_mps * passing.time_s;
      const double y_m = thing.y_m + thing.velocity_y_mps * passing.time_s;
      const double bearing_rad = geometry::wrap_angle_rad(
          std::atan2(y_m - passing.pose.y_m, x_m - passing.pose.x_m) - passing.pose.yaw_rad);
      const long beam = std::clamp(
          std::lround((bearing_rad - scanner_.bearing_min_rad) / scanner_.bearing_step_rad), 0L,
          scanner_.num_beams - 1L);
      passing.time_s =
          static_cast<double>(beam - scanner_.num_beams / 2) * scanner_.beam_period_us * 1e-6;
      if (poses_.size() > 1) passing.pose = poses_[static_cast<std::size_t>(beam)];
    }
    return passing;
  }

  /// Distance at which the tilted scan plane meets the ground.
  double ground_m(double bearing_rad) const {
    const double falls =
        tilt_.pitch_rad * std::cos(bearing_rad) - tilt_.roll_rad * std::sin(bearing_rad);
    return falls > 0.0 ? scanner_.height_m / falls : std::numeric_limits<double>::infinity();
  }

  /// Interval of the scanner's field of view, relative to a bearing.
  AngularInterval field_of_view(double bearing_rad) const {
    const double half_rad = 0.5 * (scanner_.num_beams - 1) * scanner_.bearing_step_rad;
    if (2.0 * half_rad + 1.5 * scanner_.bearing_step_rad >= 2.0 * geometry::kPi) {
      return {-geometry::kPi, geometry::kPi};
    }
    const double off_rad =
        geometry::wrap_angle_rad(bearing_rad - scanner_.bearing_min_rad - half_rad);
    return {-half_rad - off_rad, half_rad - off_rad};
  }

  /// Collects the object's own shapes within range and view, and all shapes that may be in front of
  /// them.
  void gather(int index, const Passing& passing, double middle_rad, const AngularInterval& view) {
    own_.clear();
    others_.clear();
    AngularInterval hull{geometry::kPi, -geometry::kPi};
    for (const Outline& shape : shapes_) {
      if (shape.target != index) continue;
      const Outline moved = seen_from(shape, passing);
      if (std::hypot(moved.x_m, moved.y_m) - moved.reach_m() > scanner_.range_max_m) continue;
      const AngularInterval interval = overlap(moved.interval(middle_rad), view);
      if (interval.width_rad() <= 0.0) continue;
      own_.push_back({moved, interval});
      hull.low_rad = std::min(hull.low_rad, interval.low_rad);
      hull.high_rad = std::max(hull.high_rad, interval.high_rad);
    }
    if (own_.empty()) return;
    for (const Outline& shape : shapes_) {
      if (shape.target == index) continue;
      const Outline moved = seen_from(shape, passing);
      const double distance_m = std::hypot(moved.x_m, moved.y_m);
      if (distance_m - moved.reach_m() > scanner_.range_max_m) continue;
      const AngularInterval interval = moved.interval(middle_rad);
      if (overlap(interval, hull).width_rad() > 0.0) others_.push_back({moved, interval});
    }
  }

  static Outline seen_from(Outline shape, const Passing& passing) {
    shape.x_m += shape.velocity_x_mps * passing.time_s - passing.pose.x_m;
    shape.y_m += shape.velocity_y_mps * passing.time_s - passing.pose.y_m;
    return shape;
  }

  std::vector<AngularInterval> visible_parts(const Piece& piece, double middle_rad) const {
    std::vector<AngularInterval> hidden;
    for (const Piece& other : others_) {
      const AngularInterval shared = overlap(piece.interval, other.interval);
      if (shared.width_rad() <= 0.0) continue;
      const double direction_rad = middle_rad + 0.5 * (shared.low_rad + shared.high_rad);
      if (other.outline.range_m(direction_rad) < piece.outline.range_m(direction_rad)) {
        hidden.push_back(shared);
      }
    }
    return without(piece.interval, std::move(hidden));
  }

  int count_beams(const std::vector<AngularInterval>& visible, double middle_rad,
                  double yaw_rad) const {
    const double step_rad = scanner_.bearing_step_rad;
    int num_beams = 0;
    for (const AngularInterval& part : visible) {
      const double first_rad =
          geometry::wrap_angle_rad(middle_rad - yaw_rad) - scanner_.bearing_min_rad;
      for (int turn = -2; turn <= 2; ++turn) {
        const double zero_rad = first_rad + 2.0 * geometry::kPi * turn;
        const double first = std::max(0.0, std::ceil((zero_rad + part.low_rad) / step_rad));
        const double last =
            std::min(scanner_.num_beams - 1.0, std::floor((zero_rad + part.high_rad) / step_rad));
        for (double beam = first; beam <= last; beam += 1.0) {
          const double direction_rad = beam * step_rad - zero_rad + middle_rad;
          const double range_m = own_range_m(direction_rad, middle_rad);
          if (range_m >= scanner_.range_min_m && range_m <= scanner_.range_max_m &&
              range_m < ground_m(direction_rad - yaw_rad)) {
            ++num_beams;
          }
        }
      }
    }
    return num_beams;
  }

  double own_range_m(double direction_rad, double middle_rad) const {
    double nearest_m = std::numeric_limits<double>::infinity();
    const double relative_rad = direction_rad - middle_rad;
    for (const Piece& piece : own_) {
      if (relative_rad < piece.interval.low_rad || relative_rad > piece.interval.high_rad) continue;
      nearest_m = std::min(nearest_m, piece.outline.range_m(direction_rad));
    }
    return nearest_m;
  }

  bool in_picture(const std::vector<AngularInterval>& own, double distance_m,
                  double bearing_rad) const {
    if (!has_camera_) return false;
    for (const double edge_rad : {own.front().low_rad, own.back().high_rad}) {
      const double b = bearing_rad + edge_rad;
      const auto pixel = camera_.project(
          T_camera_laser_({distance_m * std::cos(b), distance_m * std::sin(b), 0.0}));
      if (!pixel || !camera_.in_image(*pixel)) return false;
    }
    return true;
  }

  const std::vector<Pose2>& poses_;
  const ScannerConfig& scanner_;
  Tilt tilt_;
  bool has_camera_;
  geometry::CameraModel camera_;
  geometry::LaserToCamera T_camera_laser_;
  std::vector<Outline> shapes_;
  std::vector<Piece> own_;
  std::vector<Piece> others_;
};

}  // namespace

std::vector<TrueObservation> observe_truth(const World& world,
                                           const std::vector<TruthObject>& truth,
                                           const std::vector<Pose2>& T_map_laser,
                                           const ScannerConfig& scanner,
                                           const geometry::CameraConfig& camera, const Tilt& tilt) {
  if (T_map_laser.size() != 1 &&
      T_map_laser.size() != static_cast<std::size_t>(scanner.num_beams)) {
    throw std::invalid_argument("observe_truth: needs one pose, or one per beam");
  }
  TruthObserver observer(world, T_map_laser, scanner, camera, tilt);
  std::vector<TrueObservation> observations;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    TrueObservation seen;
    if (observer.observe(static_cast<int>(i), truth[i], seen)) observations.push_back(seen);
  }
  return observations;
}

std::vector<TrueObservation> true_observations(const Simulator& simulator, const RigConfig& rig,
                                               std::int64_t index) {
  if (!simulator.is_level()) {
    throw std::invalid_argument(
        "true_observations: the ground is not level; give a rig without simulation.terrain");
  }
  const Surroundings at = simulator.surroundings_of_scan(index);
  std::vector<TrueObservation> observations = observe_truth(
      at.world, at.truth, at.T_map_laser, rig.simulation.scanner, rig.camera, at.tilt);
  for (TrueObservation& observation : observations) {
    observation.utime = simulator.scan_utime(index);
  }
  return observations;
}

}  // namespace orchard::simulation

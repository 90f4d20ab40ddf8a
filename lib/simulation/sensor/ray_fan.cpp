// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/ray_fan.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::simulation {
namespace {

/// Distance along a ray to a circle's near side, or kNoHit. Ray and circle are in one frame.
double ray_circle(double dx, double dy, double cx, double cy, double radius_m) {
  const double along_m = cx * dx + cy * dy;
  const double across_m = cx * dy - cy * dx;
  const double inside = radius_m * radius_m - across_m * across_m;
  if (inside < 0.0 || along_m <= 0.0) return kNoHit;
  const double range_m = along_m - std::sqrt(inside);
  return range_m > 0.0 ? range_m : kNoHit;
}

/// Range at which a ray enters a box, and the cosine of incidence.
struct BoxHit {
  double range_m = kNoHit;
  double cosine = 0.0;
};

/// `towards` is the ray's direction, `centre` the box's centre from the ray's start; axes of map.
BoxHit ray_box(const std::array<double, 3>& direction, const std::array<double, 3>& centre,
               const Box& box) {
  // Slab method in the box's own axes.
  const double c = std::cos(box.yaw_rad), s = std::sin(box.yaw_rad);
  const auto [dx, dy, dz] = direction;
  const auto [cx, cy, cz] = centre;
  const std::array<double, 3> towards{c * dx + s * dy, -s * dx + c * dy, dz};
  const std::array<double, 3> from{-(c * cx + s * cy), -(-s * cx + c * cy), -cz};
  const std::array<double, 3> half{0.5 * box.length_m, 0.5 * box.width_m, 0.5 * box.height_m};
  double enter_m = 0.0, leave_m = kNoHit, cosine = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (std::abs(towards[axis]) < 1e-12) {
      if (std::abs(from[axis]) > half[axis]) return {};
      continue;
    }
    const double one_m = (-half[axis] - from[axis]) / towards[axis];
    const double other_m = (half[axis] - from[axis]) / towards[axis];
    if (std::min(one_m, other_m) > enter_m) {
      enter_m = std::min(one_m, other_m);
      cosine = std::abs(towards[axis]);
    }
    leave_m = std::min(leave_m, std::max(one_m, other_m));
  }
  return enter_m > 0.0 && enter_m < leave_m ? BoxHit{enter_m, cosine} : BoxHit{};
}

bool moves(const Cylinder& cylinder) {
  return cylinder.velocity_x_mps != 0.0 || cylinder.velocity_y_mps != 0.0;
}

}  // namespace

RayFan::RayFan(const std::vector<Pose2>& T_map_laser, const ScannerConfig& scanner, int num_rays,
               std::uint64_t leaf_bits)
    : level_(&T_map_laser),
      scanner_(scanner),
      num_rays_(num_rays),
      leaf_bits_(leaf_bits),
      hits_(static_cast<std::size_t>(scanner.num_beams) * num_rays) {
  middle_ = T_map_laser[T_map_laser.size() / 2];
  for (const Pose2& pose : T_map_laser) {
    moved_m_ = std::max(moved_m_, std::hypot(pose.x_m - middle_.x_m, pose.y_m - middle_.y_m));
    turned_rad_ =
        std::max(turned_rad_, std::abs(geometry::wrap_angle_rad(pose.yaw_rad - middle_.yaw_rad)));
  }
}

RayFan::RayFan(const UnevenSweep& sweep, const ScannerConfig& scanner, int num_rays,
               std::uint64_t leaf_bits)
    : uneven_(&sweep),
      scanner_(scanner),
      num_rays_(num_rays),
      leaf_bits_(leaf_bits),
      hits_(static_cast<std::size_t>(scanner.num_beams) * num_rays) {
  const Eigen::Isometry3d T_laser_map =
      sweep.T_map_laser[sweep.T_map_laser.size() / 2].inverse(Eigen::Isometry);
  for (const Eigen::Isometry3d& pose : sweep.T_map_laser) {
    const Eigen::Isometry3d motion = T_laser_map * pose;
    moved_m_ = std::max(moved_m_, motion.translation().norm());
    turned_rad_ = std::max(turned_rad_, Eigen::AngleAxisd(motion.linear()).angle());
  }
}

void RayFan::add(const World& world) {
  for (const Cylinder& cylinder : world.cylinders) add(cylinder);
  for (const Box& box : world.boxes) add(box);
}

void RayFan::add(const Cylinder& cylinder) {
  const double way_m =
      moves(cylinder)
          ? std::hypot(cylinder.velocity_x_mps, cylinder.velocity_y_mps) * std::abs(time_s(0))
          : 0.0;
  if (uneven_ != nullptr) {
    const double ground_m = uneven_->terrain.height_m(cylinder.x_m, cylinder.y_m);
    Bearing to = uneven_bearing_of(cylinder, ground_m);
    to.radius_m += way_m;
    return for_each_beam(to, [&](int beam) { cast(cylinder, ground_m, beam); });
  }
  const double z_m = scanner_.height_m;
  if (z_m < cylinder.base_m || z_m > cylinder.base_m + cylinder.height_m) return;
  for_each_beam(bearing_of(cylinder.x_m, cylinder.y_m, cylinder.radius_m + way_m),
                [&](int beam) { cast(cylinder, 0.0, beam); });
}

void RayFan::add(const Box& box) {
  const double radius_m = 0.5 * std::hypot(box.length_m, box.width_m);
  if (uneven_ != nullptr) {
    const double ground_m = uneven_->terrain.height_m(box.x_m, box.y_m);
    const Cylinder outline{box.x_m, box.y_m, radius_m, box.height_m, box.base_m, box.target, {}};
    return for_each_beam(uneven_bearing_of(outline, ground_m),
                         [&](int beam) { cast(box, ground_m, beam); });
  }
  const double z_m = scanner_.height_m;
  if (z_m < box.base_m || z_m > box.base_m + box.height_m) return;
  for_each_beam(bearing_of(box.x_m, box.y_m, radius_m), [&](int beam) { cast(box, 0.0, beam); });
}

RayFan::Bearing RayFan::bearing_of(double x_m, double y_m, double radius_m) const {
  const double dx = x_m - middle_.x_m, dy = y_m - middle_.y_m;
  return {std::atan2(dy, dx) - middle_.yaw_rad, std::hypot(dx, dy), radius_m, turned_rad_};
}

/// The scan plane cuts a cylinder in an ellipse about the point where it meets its axis.
RayFan::Bearing RayFan::uneven_bearing_of(const Cylinder& outline, double ground_m) const {
  const auto& poses = uneven_->T_map_laser;
  const Eigen::Isometry3d& T_map_laser = poses[poses.size() / 2];
  const Eigen::Vector3d normal = T_map_laser.linear().col(2);
  const Eigen::Vector3d axis(outline.lean_x, outline.lean_y, 1.0);
  const Eigen::Vector3d at_scan(outline.x_m, outline.y_m, ground_m + scanner_.height_m);
  const double lowest_m = outline.base_m - scanner_.height_m;
  const double steepness = normal.dot(axis);
  const double cut_m = normal.dot(T_map_laser.translation() - at_scan) / steepness;
  const double up_m =
      std::isfinite(cut_m) ? std::clamp(cut_m, lowest_m, lowest_m + outline.height_m) : 0.0;
  const Eigen::Vector3d p_laser =
      T_map_laser.inverse(Eigen::Isometry) * Eigen::Vector3d(at_scan + up_m * axis);
  const double distance_m = std::hypot(p_laser.x(), p_laser.y());
  const double widest_m = outline.radius_m - std::min(0.0, lowest_m) * outline.taper;
  // An ellipse much longer than wide may be met anywhere.
  constexpr double kLong = 5.0;
  const double length = axis.norm() / std::abs(steepness);
  return {std::atan2(p_laser.y(), p_laser.x()), distance_m,
          length < kLong ? widest_m * length : distance_m, turned_rad_ * axis.norm()};
}

/// Calls `function` for every beam that may meet an object.
template <class Function>
void RayFan::for_each_beam(const Bearing& to, const Function& function) const {
  const double clear_m = to.distance_m - to.radius_m - moved_m_;
  if (clear_m > scanner_.range_max_m * 1.1) return;
  double half_rad = geometry::kPi;
  if (clear_m > 1e-3) {
    half_rad = std::asin(std::min(1.0, to.radius_m / to.distance_m)) + to.spread_rad +
               std::asin(std::min(1.0, moved_m_ / to.distance_m)) + 0.5 * scanner_.spot_rad +
               std::asin(std::min(1.0, 0.5 * scanner_.spot_m / to.distance_m));
  }
  const double step = scanner_.bearing_step_rad;
  // Try each direction in several turns: scanners of 360 degrees may begin anywhere.
  for (int turn = -2; turn <= 2; ++turn) {
    const double centre = (geometry::wrap_angle_rad(to.bearing_rad) + 2.0 * geometry::kPi * turn -
                           scanner_.bearing_min_rad) /
                          step;
    const double first = std::max(0.0, std::ceil(centre - half_rad / step));
    const double last = std::min(scanner_.num_beams - 1.0, std::floor(centre + half_rad / step));
    for (int beam = static_cast<int>(first); beam <= static_cast<int>(last); ++beam) {
      function(beam);
    }
  }
}

/// Time of a beam relative to the middle of the sweep.
double RayFan::time_s(int beam) const {
  return (beam - scanner_.num_beams / 2) * scanner_.beam_period_us * 1e-6;
}

RayFan::Ray RayFan::ray_of(int beam, int ray) const {
  if (uneven_ != nullptr) return uneven_ray_of(beam, ray);
  const Pose2& pose = of_beam(*level_, beam);
  const double axis_rad =
      pose.yaw_rad + scanner_.bearing_min_rad + beam * scanner_.bearing_step_rad;
  const double offset = num_rays_ == 1 ? 0.0 : (ray + 0.5) / num_rays_ - 0.5;
  const double angle_rad = axis_rad + offset * scanner_.spot_rad;
  const double aside_m = offset * scanner_.spot_m;
  return {std::cos(angle_rad),
          std::sin(angle_rad),
          0.0,
          pose.x_m - aside_m * std::sin(axis_rad),
          pose.y_m + aside_m * std::cos(axis_rad),
          scanner_.height_m};
}

RayFan::Ray RayFan::uneven_ray_of(int beam, int ray) const {
  const Eigen::Isometry3d& T_map_laser = of_beam(uneven_->T_map_laser, beam);
  const double axis_rad = scanner_.bearing_min_rad + beam * scanner_.bearing_step_rad;
  const double offset = num_rays_ == 1 ? 0.0 : (ray + 0.5) / num_rays_ - 0.5;
  const double angle_rad = axis_rad + offset * scanner_.spot_rad;
  const double aside_m = offset * scanner_.spot_m;
  const Eigen::Vector3d towards =
      T_map_laser.linear() * Eigen::Vector3d(std::cos(angle_rad), std::sin(angle_rad), 0.0);
  const Eigen::Vector3d from = T_map_laser * Eigen::Vector3d(-aside_m * std::sin(axis_rad),
                                                             aside_m * std::cos(axis_rad), 0.0);
  return {towards.x(), towards.y(), towards.z(), from.x(), from.y(), from.z()};
}

/// Penetration depth of a beam into leaves: exponentially distributed (Beer-Lambert).
double RayFan::leaf_depth_m(const Cylinder& cylinder, int beam) const {
  const auto which = static_cast<std::uint64_t>(cylinder.target) << 32;
  const std::uint64_t bits = mix_bits(leaf_bits_ ^ which ^ static_cast<std::uint64_t>(beam));
  const double uniform = static_cast<double>((bits >> 11) + 1) * 0x1p-53;
  return -cylinder.leaf_depth_m * std::log(uniform);
}

/// A level cut of a cylinder at h above the height of the scan is a circle about p + lean h of
/// radius r - taper h. A ray is inside between the roots of |w + t v|^2 = (r_0 + t r_1)^2 and
/// between the planes of its ends.
RayFan::Span RayFan::span_of(const Ray& ray, const Cylinder& cylinder, double ground_m) const {
  if (uneven_ == nullptr) {
    const double cx = cylinder.x_m - ray.x_m, cy = cylinder.y_m - ray.y_m;
    const double enter_m = ray_circle(ray.dx, ray.dy, cx, cy, cylinder.radius_m);
    return {enter_m, 2.0 * (cx * ray.dx + cy * ray.dy) - enter_m};
  }
  const double up_m = ray.z_m - ground_m;
  const double h_m = up_m - scanner_.height_m;
  const double vx = ray.dx - cylinder.lean_x * ray.dz, vy = ray.dy - cylinder.lean_y * ray.dz;
  const double wx = ray.x_m - cylinder.x_m - cylinder.lean_x * h_m;
  const double wy = ray.y_m - cylinder.y_m - cylinder.lean_y * h_m;
  const double r_0 = cylinder.radius_m - cylinder.taper * h_m, r_1 = -cylinder.taper * ray.dz;
  const double a = vx * vx + vy * vy - r_1 * r_1;
  const double b = wx * vx + wy * vy - r_0 * r_1;
  const double inside = b * b - a * (wx * wx + wy * wy - r_0 * r_0);
  if (inside < 0.0 || a <= 0.0) return {};
  Span span{(-b - std::sqrt(inside)) / a, (-b + std::sqrt(inside)) / a};
  const double to_base_m = cylinder.base_m - up_m, to_top_m = to_base_m + cylinder.height_m;
  if (ray.dz == 0.0)
    return to_base_m <= 0.0 && to_top_m >= 0.0 && span.enter_m > 0.0 ? span : Span{};
  span.enter_m = std::max(span.enter_m, std::min(to_base_m / ray.dz, to_top_m / ray.dz));
  span.leave_m = std::min(span.leave_m, std::max(to_base_m / ray.dz, to_top_m / ray.dz));
  return span.enter_m > 0.0 && span.enter_m < span.leave_m ? span : Span{};
}

double RayFan::cosine_of(const Ray& ray, const Cylinder& cylinder, double ground_m,
                         double range_m) const {
  if (uneven_ == nullptr) {
    const double cx = cylinder.x_m - ray.x_m, cy = cylinder.y_m - ray.y_m;
    return ((cx - range_m * ray.dx) * ray.dx + (cy - range_m * ray.dy) * ray.dy) /
           cylinder.radius_m;
  }
  const double h_m = ray.z_m + range_m * ray.dz - ground_m - scanner_.height_m;
  const double ex = ray.x_m + range_m * ray.dx - cylinder.x_m - cylinder.lean_x * h_m;
  const double ey = ray.y_m + range_m * ray.dy - cylinder.y_m - cylinder.lean_y * h_m;
  const double ez = cylinder.taper * (cylinder.radius_m - cylinder.taper * h_m) -
                    ex * cylinder.lean_x - ey * cylinder.lean_y;
  return (ex * ray.dx + ey * ray.dy + ez * ray.dz) / std::sqrt(ex * ex + ey * ey + ez * ez);
}

void RayFan::cast(const Cylinder& standing, double ground_m, int beam) {
  Cylinder cylinder = standing;
  if (moves(cylinder)) {
    cylinder.x_m += cylinder.velocity_x_mps * time_s(beam);
    cylinder.y_m += cylinder.velocity_y_mps * time_s(beam);
  }
  for (int ray = 0; ray < num_rays_; ++ray) {
    const Ray r = ray_of(beam, ray);
    const Span span = span_of(r, cylinder, ground_m);
    double range_m = span.enter_m;
    if (cylinder.leaf_depth_m > 0.0 && range_m != kNoHit) {
      range_m += leaf_depth_m(cylinder, beam);
      if (range_m > span.leave_m) continue;
    }
    Hit& hit = hit_of(beam, ray);
    if (!(range_m < hit.range_m)) continue;
    hit = {range_m, cylinder.target,
           cylinder.appearance.reflectivity * std::abs(cosine_of(r, cylinder, ground_m, range_m))};
  }
}

void RayFan::cast(const Box& box, double ground_m, int beam) {
  const double middle_m = ground_m + box.base_m + 0.5 * box.height_m;
  for (int ray = 0; ray < num_rays_; ++ray) {
    const Ray r = ray_of(beam, ray);
    const BoxHit entered =
        ray_box({r.dx, r.dy, r.dz}, {box.x_m - r.x_m, box.y_m - r.y_m, middle_m - r.z_m}, box);
    Hit& hit = hit_of(beam, ray);
    if (entered.range_m < hit.range_m) {
      hit = {entered.range_m, box.target, box.appearance.reflectivity * entered.cosine};
    }
  }
}

}  // namespace orchard::simulation

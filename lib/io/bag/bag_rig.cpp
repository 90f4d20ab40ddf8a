// SPDX-License-Identifier: BSD-3-Clause
#include "io/bag/bag_rig.hpp"

#include <cmath>

#include "io/config/camera_import.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

/// derived: the cosine of a tilt that changes ranges by 1 %, the default of
/// laser.range_sd_fraction.
constexpr double kLevel = 0.99;
constexpr int kDecimals = 6;

class RigFinder {
 public:
  RigFinder(const ros::FrameTree& tree, const BagFrames& frames) : tree_(tree), frames_(frames) {}

  void add_scanner(const std::string& section, const std::string& frame) {
    const auto T_base_laser = pose_of(frame, section + ".mount_*");
    if (!T_base_laser) return;
    const Eigen::Matrix3d R = T_base_laser->rotation();
    if (R(2, 2) < kLevel) {
      return note(section + ".mount_* is not set: the frame " + frame +
                  (R(2, 2) < 0.0 ? " is upside down" : " is tilted") +
                  ", which a mount in the plane cannot tell");
    }
    set(section + ".mount_x_m", fixed_text(T_base_laser->translation().x(), kDecimals));
    set(section + ".mount_y_m", fixed_text(T_base_laser->translation().y(), kDecimals));
    set(section + ".mount_yaw_rad", fixed_text(std::atan2(R(1, 0), R(0, 0)), kDecimals));
  }

  void add_camera() {
    const auto T_base_camera = pose_of(frames_.image, "camera.delta_m and phi_rad");
    const auto T_camera_laser = tree_.between(frames_.image, frames_.scan);
    if (!T_base_camera || !T_camera_laser) return;
    // The y axis of an optical frame points down.
    if (T_base_camera->rotation()(2, 1) > -0.5) {
      return note("camera.delta_m and phi_rad are not set: " + frames_.image +
                  " is not an optical frame (x right, y down, z forward)");
    }
    set("camera.delta_m", config_numbers(T_camera_laser->translation(), kDecimals));
    set("camera.phi_rad",
        config_numbers(geometry::paper_angles_rad(T_camera_laser->rotation()), kDecimals));
  }

  void add_antenna() {
    const auto T_base_gnss = pose_of(frames_.gnss, "pose.gnss.antenna_m");
    if (T_base_gnss)
      set("pose.gnss.antenna_m", config_numbers(T_base_gnss->translation().head<2>(), kDecimals));
  }

  void set(const std::string& key, const std::string& value) {
    rig_.values.push_back({key, value});
  }
  BagRig take() { return std::move(rig_); }

 private:
  std::optional<Eigen::Isometry3d> pose_of(const std::string& frame, const std::string& keys) {
    auto pose = tree_.between(frames_.base, frame);
    if (!pose) {
      note(keys + " is not set: no fixed transforms lead from " + frames_.base + " to \"" + frame +
           "\"");
    }
    return pose;
  }
  void note(const std::string& text) { rig_.notes.push_back(text); }

  const ros::FrameTree& tree_;
  const BagFrames& frames_;
  BagRig rig_;
};

}  // namespace

BagRig bag_rig(const ros::FrameTree& tree, const BagFrames& frames,
               const std::optional<geometry::CameraIntrinsics>& lens) {
  RigFinder finder(tree, frames);
  if (!frames.scan_rear.empty()) finder.set("laser_rear.enabled", "true");
  if (!frames.scan.empty() && frames.image.empty()) finder.set("camera.enabled", "false");
  if (lens && !frames.image.empty()) {
    for (const ConfigValue& value : camera_values(*lens)) finder.set(value.key, value.value);
  }
  if (!tree.empty()) {
    if (!frames.scan.empty()) finder.add_scanner("laser", frames.scan);
    if (!frames.scan_rear.empty()) finder.add_scanner("laser_rear", frames.scan_rear);
    if (!frames.image.empty()) finder.add_camera();
    if (!frames.gnss.empty()) finder.add_antenna();
  }
  return finder.take();
}

}  // namespace orchard::io

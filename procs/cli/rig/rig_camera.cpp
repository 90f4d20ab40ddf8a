// SPDX-License-Identifier: BSD-3-Clause
#include "cli/rig/rig_camera.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "io/atomic_file.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

constexpr const char* kTag = "orchard calibrate camera";

template <std::size_t N>
std::string list(const std::array<double, N>& numbers, int digits) {
  std::string text = "[";
  for (std::size_t i = 0; i < N; ++i) {
    text += (i > 0 ? ", " : "") + fixed_text(numbers[i], digits);
  }
  return text + "]";
}

}  // namespace

RigTarget rig_target(const std::string& config_path, const std::string& out_path) {
  RigTarget target{config_path, out_path.empty() ? config_path : out_path};
  if (target.config_path.empty() && std::filesystem::exists(target.out_path)) {
    target.config_path = target.out_path;
  }
  if (!target.config_path.empty()) io::load_config(target.config_path);
  return target;
}

void check_size(const RigTarget& target, const geometry::CameraIntrinsics& camera,
                const std::string& what, bool force) {
  if (force || target.config_path.empty()) return;
  const io::Config config = io::load_config(target.config_path);
  const geometry::CameraIntrinsics& rig = config.camera.intrinsics;
  if (rig.width_px == camera.width_px && rig.height_px == camera.height_px) return;
  throw io::FileError(
      target.config_path + ": camera.width_px x height_px is " + std::to_string(rig.width_px) +
      " x " + std::to_string(rig.height_px) + ", but the size of " + what + " is " +
      std::to_string(camera.width_px) + " x " + std::to_string(camera.height_px) +
      "; give the configuration of this camera, correct its size, or replace it with --force");
}

std::vector<io::ConfigValue> rig_values_of(const geometry::CameraIntrinsics& camera) {
  return {{"camera.width_px", std::to_string(camera.width_px)},
          {"camera.height_px", std::to_string(camera.height_px)},
          {"camera.fc_px", list(camera.fc_px, 3)},
          {"camera.cc_px", list(camera.cc_px, 3)},
          {"camera.alpha_c", fixed_text(camera.alpha_c, 6)},
          {"camera.kc", list(camera.kc, 6)}};
}

void write_rig_camera(const RigTarget& target, const geometry::CameraIntrinsics& camera,
                      const std::string& note, bool quiet) {
  if (target.out_path.empty()) return;
  std::string line = note;  // file names may contain line breaks; a comment is one line
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  const auto values = rig_values_of(camera);
  if (target.config_path.empty()) {
    io::write_file_atomically(target.out_path,
                              io::edit_config("", target.out_path, values, kTag, line));
  } else {
    io::edit_config_file(target.config_path, target.out_path, values, kTag, line);
  }
  if (quiet) return;
  std::printf("written to %s\n", target.out_path.c_str());
  if (!target.config_path.empty()) {
    std::printf(
        "delta_m and phi_rad depend on the intrinsics: run `orchard calibrate laser-camera` "
        "again\n");
  }
}

}  // namespace orchard::cli

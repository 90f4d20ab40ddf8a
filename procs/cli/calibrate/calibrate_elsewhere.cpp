// SPDX-License-Identifier: BSD-3-Clause
// `orchard` declares the options of `orchard calibrate` and hands the work to the program beside
// it.
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "cli/calibrate/calibrate_appearance.hpp"
#include "cli/calibrate/calibrate_camera.hpp"
#include "cli/calibrate/calibrate_delay.hpp"
#include "cli/calibrate/calibrate_laser_camera.hpp"
#include "cli/calibrate/calibrate_probability.hpp"
#include "cli/calibrate/calibrate_trunks.hpp"
#include "io/file_error.hpp"

namespace orchard::cli {
namespace {

/// The words that this process was started with, each ended by a zero.
std::string own_command_line() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Goes on as orchard-calibrate with the same words; returns only by an exception.
int go_on_as_calibrate() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string program = (self.parent_path() / "orchard-calibrate").string();
  std::string words = own_command_line();
  std::vector<char*> arguments;
  for (std::size_t begin = 0, end; (end = words.find('\0', begin)) != words.npos; begin = end + 1) {
    arguments.push_back(&words[begin]);
  }
  arguments.push_back(nullptr);
  if (!error && arguments.size() > 1) execv(program.c_str(), arguments.data());
  throw io::FileError(
      program + ": cannot be started (" + std::strerror(errno) +
      "); it belongs beside orchard: `scripts/build.sh orchard-calibrate` makes it");
}

}  // namespace

int run_calibrate_appearance(const CalibrateAppearanceOptions&) { return go_on_as_calibrate(); }
int run_calibrate_camera(const CalibrateCameraOptions&) { return go_on_as_calibrate(); }
int run_calibrate_delay(const CalibrateDelayOptions&) { return go_on_as_calibrate(); }
int run_calibrate_laser_camera(const CalibrateLaserCameraOptions&) { return go_on_as_calibrate(); }
int run_calibrate_probability(const CalibrateProbabilityOptions&) { return go_on_as_calibrate(); }
int run_calibrate_trunks(const CalibrateTrunksOptions&) { return go_on_as_calibrate(); }

}  // namespace orchard::cli

// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/recording_sensors.hpp"

#include <yaml-cpp/yaml.h>

#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include "geometry/angles.hpp"
#include "io/file_error.hpp"

namespace orchard::io {
namespace {

constexpr int kMaxBeams = 100000;

/// One section of the file; records which keys were read.
class Section {
 public:
  Section(YAML::Node node, std::string file, std::string prefix)
      : node_(std::move(node)), file_(std::move(file)), prefix_(std::move(prefix)) {
    if (!node_.IsMap()) fail(node_, "must be a section with keys of its own");
  }

  bool has(const std::string& key) { return find(key).IsDefined(); }

  double number(const std::string& key, double lo, double hi) {
    const YAML::Node field = require(key);
    const std::string text = field.IsScalar() ? field.Scalar() : "(no number)";
    double value = 0.0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec != std::errc() || result.ptr != text.data() + text.size() ||
        !(value >= lo && value <= hi)) {
      fail(field, key + " = " + text + ": must be a number in [" + std::to_string(lo) + ", " +
                      std::to_string(hi) + "]");
    }
    return value;
  }

  Section section(const std::string& key) {
    const YAML::Node field = require(key);
    return Section(field, file_, prefix_ + key + ".");
  }

  void refuse_unknown() const {
    std::set<std::string> seen;
    for (const auto& entry : node_) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "(not a text)";
      if (!seen.insert(key).second) fail(entry.first, key + " is given twice; remove one");
      if (known_.count(key)) continue;
      std::string names;
      for (const std::string& known : known_) names += (names.empty() ? "" : ", ") + known;
      fail(entry.first, key + ": unknown key; the keys are " + names);
    }
  }

  [[noreturn]] void fail(const YAML::Node& where, const std::string& what) const {
    throw FileError(file_ + ":" + std::to_string(where.Mark().line + 1) + ": " + prefix_ + what);
  }
  [[noreturn]] void fail(const std::string& what) const { fail(node_, what); }

 private:
  YAML::Node find(const std::string& key) {
    known_.insert(key);
    for (const auto& entry : node_) {
      if (entry.first.IsScalar() && entry.first.Scalar() == key) return entry.second;
    }
    return YAML::Node(YAML::NodeType::Undefined);
  }
  YAML::Node require(const std::string& key) {
    const YAML::Node field = find(key);
    if (!field.IsDefined()) fail(node_, key + " is missing; add it");
    return field;
  }

  YAML::Node node_;
  std::string file_;
  std::string prefix_;
  std::set<std::string> known_;
};

}  // namespace

LaserDescription parse_sensors_yaml(const std::string& yaml, const std::string& name) {
  constexpr double kTurn = 2.0 * geometry::kPi + 1e-6;
  try {
    Section root(YAML::Load(yaml), name, "");
    Section section = root.section("laser");
    root.refuse_unknown();
    LaserDescription laser;
    const double num_beams = section.number("num_beams", 1, kMaxBeams);
    laser.num_beams = static_cast<int>(num_beams);
    if (num_beams != laser.num_beams) section.fail("num_beams must be a whole number");
    laser.bearing_min_rad = section.number("bearing_min_rad", -kTurn, kTurn);
    laser.bearing_step_rad = section.number("bearing_step_rad", -1.0, 1.0);
    if (laser.bearing_step_rad == 0.0) section.fail("bearing_step_rad must not be 0");
    laser.range_min_m = section.number("range_min_m", 0.0, 1e4);
    laser.range_max_m = section.number("range_max_m", 0.0, 1e4);
    if (laser.range_max_m <= laser.range_min_m) {
      section.fail("range_max_m must be above range_min_m");
    }
    if (section.has("beam_period_us")) {
      laser.beam_period_us = section.number("beam_period_us", 0.0, 1e6);
    }
    if (section.has("mount")) {
      Section mount = section.section("mount");
      laser.mount.x_m = mount.number("x_m", -100.0, 100.0);
      laser.mount.y_m = mount.number("y_m", -100.0, 100.0);
      laser.mount.yaw_rad = mount.number("yaw_rad", -kTurn, kTurn);
      mount.refuse_unknown();
    }
    section.refuse_unknown();
    return laser;
  } catch (const YAML::Exception& error) {
    throw FileError(name + ":" + std::to_string(error.mark.line + 1) +
                    ": is not valid YAML: " + error.msg);
  }
}

}  // namespace orchard::io

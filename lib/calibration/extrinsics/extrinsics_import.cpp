// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/extrinsics/extrinsics_import.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "geometry/angles.hpp"

namespace orchard::calibration {
namespace {

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Position of a separate word followed by "=" or ":"; npos if there is none.
std::size_t find_name(const std::string& text, const std::string& name) {
  for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
    const std::size_t end = at + name.size();
    if (at > 0 && is_letter(text[at - 1])) continue;
    const std::size_t next = text.find_first_not_of(" \t", end);
    if (next != std::string::npos && (text[next] == '=' || text[next] == ':')) return next + 1;
  }
  return std::string::npos;
}

template <std::size_t N>
struct Numbers {
  std::array<double, N> numbers{};
  std::size_t end = 0;
};

template <std::size_t N>
Numbers<N> numbers_after(const std::string& text, const std::string& name) {
  const std::size_t at = find_name(text, name);
  if (at == std::string::npos) {
    throw std::runtime_error("has no \"" + name + " = [x y z]\"");
  }
  Numbers<N> list;
  list.end = at;
  for (double& number : list.numbers) {
    const std::size_t begin = text.find_first_not_of(" \t\r\n[](),;", list.end);
    const char* start = begin == std::string::npos ? nullptr : text.c_str() + begin;
    char* stop = nullptr;
    if (start) number = std::strtod(start, &stop);
    if (!start || stop == start || !std::isfinite(number)) {
      throw std::runtime_error("has too few numbers after \"" + name + "\"");
    }
    list.end = begin + static_cast<std::size_t>(stop - start);
  }
  return list;
}

/// Reads a matrix row by row; throws std::runtime_error if it is not a rotation.
Eigen::Matrix3d rotation_matrix(const std::string& text) {
  // derived: twice the rounding of three decimals.
  constexpr double kOff = 1e-3;  // tolerance for numbers with three decimals
  const auto rows = numbers_after<9>(text, "r").numbers;
  const Eigen::Matrix3d R =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data());
  if (!(R * R.transpose()).isIdentity(5.0 * kOff) || !(R.determinant() > 0.0)) {
    throw std::runtime_error(
        "has a matrix R that is not a rotation (its rows must be orthogonal unit vectors, its "
        "determinant 1)");
  }
  const Eigen::Quaterniond nearest(R);
  return nearest.normalized().toRotationMatrix();
}

AngleUnit stated_unit(const std::string& text, std::size_t from) {
  const std::size_t next_name = text.find('=', from);
  const std::string rest =
      text.substr(from, next_name == std::string::npos ? next_name : next_name - from);
  const bool degrees = rest.find("deg") != std::string::npos;
  const bool radians = rest.find("rad") != std::string::npos;
  if (degrees == radians) return AngleUnit::kAsStated;
  return degrees ? AngleUnit::kDegrees : AngleUnit::kRadians;
}

}  // namespace

geometry::LaserCameraExtrinsics import_extrinsics(const std::string& text, LaserAxes axes,
                                                  AngleUnit unit) {
  const std::string small = lower(text);
  geometry::LaserCameraExtrinsics extrinsics;
  extrinsics.delta_m = numbers_after<3>(small, "delta").numbers;
  if (find_name(small, "phi") == std::string::npos && find_name(small, "r") != std::string::npos) {
    extrinsics.phi_rad = geometry::paper_angles_rad(rotation_matrix(small));
  } else {
    const auto phi = numbers_after<3>(small, "phi");
    if (unit == AngleUnit::kAsStated) unit = stated_unit(small, phi.end);
    if (unit == AngleUnit::kAsStated) {
      throw std::runtime_error(
          "does not state whether phi is in deg or rad; give --angles deg or rad");
    }
    const double scale = unit == AngleUnit::kDegrees ? geometry::kPi / 180.0 : 1.0;
    for (std::size_t i = 0; i < 3; ++i) extrinsics.phi_rad[i] = scale * phi.numbers[i];
  }
  Eigen::Matrix3d R = geometry::LaserToCamera(extrinsics).rotation();
  if (axes == LaserAxes::kToolbox) {
    Eigen::Matrix3d R_toolbox_ours;  // (x, y, z) = (left, up, forward) of (forward, left, up)
    R_toolbox_ours << 0, 1, 0, 0, 0, 1, 1, 0, 0;
    R = R * R_toolbox_ours;
    extrinsics.phi_rad = geometry::paper_angles_rad(R);
  }
  // derived: the cosine of 60 degrees.
  constexpr double kMinAhead = 0.5;  // 60 degrees
  if (R(2, 0) < kMinAhead) {
    throw std::runtime_error(
        std::string(
            "gives a camera that looks away from the scanner's forward direction; try --axes ") +
        (axes == LaserAxes::kToolbox ? "orchard" : "toolbox") + " or the other unit of --angles");
  }
  return extrinsics;
}

}  // namespace orchard::calibration

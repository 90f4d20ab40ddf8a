// SPDX-License-Identifier: BSD-3-Clause
#include <charconv>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "io/config/camera_import.hpp"
#include "io/file_error.hpp"

namespace orchard::io {
namespace {

/// The largest vector needed has five numbers; longer ones are ignored.
constexpr std::size_t kNumbersMax = 16;

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool is_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/// Parses "[ 1.0 ; 2.0 ]" or "3"; none for anything else.
std::optional<std::vector<double>> numbers_of(std::string_view text) {
  std::vector<double> numbers;
  bool open = false, closed = false;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (is_space(c) || c == '\n' || c == ',' || (c == ';' && open && !closed)) {
      ++i;
    } else if (c == '[' && !open && numbers.empty()) {
      open = true;
      ++i;
    } else if (c == ']' && open && !closed) {
      closed = true;
      ++i;
    } else {
      if (closed || (!open && !numbers.empty()) || numbers.size() == kNumbersMax) {
        return std::nullopt;
      }
      double value = 0.0;
      const char* begin = text.data() + i + (c == '+' ? 1 : 0);
      const auto parsed = std::from_chars(begin, text.data() + text.size(), value);
      if (parsed.ec != std::errc() || !std::isfinite(value)) return std::nullopt;
      numbers.push_back(value);
      i = static_cast<std::size_t>(parsed.ptr - text.data());
    }
  }
  if (open != closed || numbers.empty()) return std::nullopt;
  return numbers;
}

/// Parses all "name = numbers;" of a Matlab script; the last assignment of a name is used, as in
/// Matlab.
std::map<std::string, std::vector<double>, std::less<>> assignments_in(std::string_view text) {
  std::map<std::string, std::vector<double>, std::less<>> assignments;
  std::size_t i = 0;
  while (i < text.size()) {
    // one statement: up to a ";" or a line end outside brackets, without comments
    std::string statement;
    bool in_brackets = false;
    for (; i < text.size(); ++i) {
      const char c = text[i];
      if (c == '%') {
        while (i + 1 < text.size() && text[i + 1] != '\n') ++i;
        continue;
      }
      if (c == '[') in_brackets = true;
      if (c == ']') in_brackets = false;
      if (!in_brackets && (c == ';' || c == '\n')) break;
      statement += c;
    }
    ++i;
    const std::size_t equals = statement.find('=');
    if (equals == std::string::npos) continue;
    std::size_t begin = 0, end = equals;
    while (begin < end && is_space(statement[begin])) ++begin;
    while (end > begin && is_space(statement[end - 1])) --end;
    std::string name = statement.substr(begin, end - begin);
    bool plain = !name.empty();
    for (const char c : name) plain = plain && is_name(c);
    if (!plain) continue;
    if (auto numbers = numbers_of(std::string_view(statement).substr(equals + 1))) {
      assignments[std::move(name)] = std::move(*numbers);
    }
  }
  return assignments;
}

}  // namespace

ImportedCamera parse_camera_matlab(std::string_view text, const std::string& name) {
  const auto assignments = assignments_in(text);
  const auto find = [&](std::string_view key) -> const std::vector<double>* {
    const auto entry = assignments.find(key);
    return entry == assignments.end() ? nullptr : &entry->second;
  };
  const auto need = [&](std::string_view key, std::size_t count) -> const std::vector<double>& {
    const std::vector<double>* numbers = find(key);
    if (!numbers || numbers->size() != count) {
      throw FileError(name + ": has no \"" + std::string(key) + "\" of " + std::to_string(count) +
                      (count == 1 ? " number" : " numbers") +
                      "; give the Calib_Results.m that Bouguet's toolbox saves");
    }
    return *numbers;
  };
  ImportedCamera camera;
  camera.kind = "Bouguet's Calib_Results.m";
  geometry::CameraIntrinsics& lens = camera.intrinsics;
  for (std::size_t i = 0; i < 2; ++i) {
    lens.fc_px[i] = need("fc", 2)[i];
    lens.cc_px[i] = need("cc", 2)[i];
  }
  for (std::size_t i = 0; i < 5; ++i) lens.kc[i] = need("kc", 5)[i];
  if (const auto* skew = find("alpha_c"); skew && skew->size() == 1) lens.alpha_c = (*skew)[0];
  const double nx = need("nx", 1)[0], ny = need("ny", 1)[0];
  for (const double side : {nx, ny}) {
    if (!(side >= 1.0 && side <= 1e5) || side != std::floor(side)) {
      throw FileError(name + ": nx and ny must be the size of the picture in whole pixels");
    }
  }
  lens.width_px = static_cast<int>(nx);
  lens.height_px = static_cast<int>(ny);
  // the toolbox gives "approximately three times the standard deviations"
  if (const auto* error = find("fc_error"); error && error->size() == 2) {
    camera.fc_sd_px = {(*error)[0] / 3.0, (*error)[1] / 3.0};
  }
  if (const auto* error = find("cc_error"); error && error->size() == 2) {
    camera.cc_sd_px = {(*error)[0] / 3.0, (*error)[1] / 3.0};
  }
  return camera;
}

}  // namespace orchard::io

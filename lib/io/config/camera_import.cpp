// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/camera_import.hpp"

#include <yaml-cpp/yaml.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "text/number_text.hpp"

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

/// Reads the parameters of a camera from the YAML of either tool.
class CameraYaml {
 public:
  CameraYaml(std::string_view text, std::string name) : name_(std::move(name)) {
    // OpenCV's first line is not a valid YAML directive: "%YAML:1.0"
    from_opencv_ = text.substr(0, 6) == "%YAML:";
    if (from_opencv_) text.remove_prefix(std::min(text.find('\n'), text.size()));
    try {
      root_ = YAML::Load(std::string(text));
    } catch (const YAML::Exception& error) {
      throw FileError(name_ + ": is not valid YAML (" + error.what() + ")");
    }
    if (!root_.IsMap()) fail("is not the YAML of a camera");
  }

  ImportedCamera read() {
    ImportedCamera camera;
    refuse_other_lenses();
    camera.kind = from_opencv_ ? "an OpenCV camera YAML" : "a ROS camera_info YAML";
    geometry::CameraIntrinsics& lens = camera.intrinsics;
    lens.width_px = size_of({"image_width", "image_Width"});
    lens.height_px = size_of({"image_height", "image_Height"});
    const std::vector<double> k = numbers_of({"camera_matrix", "Camera_Matrix"}, "camera_matrix");
    if (k.size() != 9)
      fail("its camera_matrix has " + std::to_string(k.size()) + " numbers instead of 9");
    if (k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0 || !(k[0] > 0.0) ||
        !(k[4] > 0.0)) {
      fail("its camera_matrix is not [fx s cx; 0 fy cy; 0 0 1]");
    }
    lens.fc_px = {k[0], k[4]};
    lens.cc_px = {k[2], k[5]};
    lens.alpha_c = k[1] / k[0];
    const std::vector<double> d = numbers_of({"distortion_coefficients", "Distortion_Coefficients"},
                                             "distortion_coefficients");
    if (d.size() != 4 && d.size() != 5 && d.size() != 8 && d.size() != 12 && d.size() != 14) {
      fail("its distortion_coefficients are " + std::to_string(d.size()) +
           " numbers instead of 4 or 5 (k1 k2 p1 p2 k3)");
    }
    for (std::size_t i = 0; i < d.size(); ++i) {
      if (i < 5) {
        lens.kc[i] = d[i];
      } else if (d[i] != 0.0) {
        fail(
            "it has more than the five distortion coefficients k1 k2 p1 p2 k3; calibrate again "
            "with model plumb_bob");
      }
    }
    return camera;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const { throw FileError(name_ + ": " + why); }

  void refuse_other_lenses() const {
    const YAML::Node model = root_["distortion_model"];
    if (model && model.IsScalar()) {
      const std::string word = model.Scalar();
      if (word != "plumb_bob" && word != "rational_polynomial") {
        fail("its distortion_model is " + word.substr(0, 40) +
             ", but only plumb_bob (k1 k2 p1 p2 k3) is supported; calibrate again with plumb_bob");
      }
    }
    const YAML::Node fisheye = root_["fisheye_model"];
    if (fisheye && fisheye.IsScalar() && fisheye.Scalar() != "0") {
      fail("it describes a fisheye lens, but only the model k1 k2 p1 p2 k3 is supported");
    }
  }

  YAML::Node find(std::initializer_list<const char*> keys) const {
    for (const char* key : keys) {
      if (const YAML::Node node = root_[key]) return node;
    }
    fail(std::string("has no ") + *keys.begin() +
         "; a ROS camera_info or OpenCV calibration file has one");
  }

  int size_of(std::initializer_list<const char*> keys) const {
    int size = 0;
    const YAML::Node node = find(keys);
    if (!node.IsScalar() || !YAML::convert<int>::decode(node, size) || size < 1) {
      fail(std::string("its ") + *keys.begin() + " is not a number of pixels");
    }
    return size;
  }

  /// Accepts "{rows, cols, data: [...]}" or the list itself.
  std::vector<double> numbers_of(std::initializer_list<const char*> keys, const char* what) const {
    YAML::Node node = find(keys);
    if (node.IsMap()) node = node["data"];
    if (!node || !node.IsSequence() || node.size() > 64) {
      fail(std::string("its ") + what + " has no list of numbers");
    }
    std::vector<double> numbers;
    for (const YAML::Node& item : node) {
      double value = 0.0;
      if (!item.IsScalar() || !YAML::convert<double>::decode(item, value) ||
          !std::isfinite(value)) {
        fail(std::string("its ") + what + " has an element that is not a finite number");
      }
      numbers.push_back(value);
    }
    return numbers;
  }

  std::string name_;
  YAML::Node root_;
  bool from_opencv_ = false;
};

}  // namespace

ImportedCamera read_camera_file(const std::string& path) {
  constexpr std::size_t kMaxBytes = std::size_t{1} << 20;
  const std::string text = read_file(path, kMaxBytes, "give the description of a camera");
  if (std::filesystem::path(path).extension() == ".m") return parse_camera_matlab(text, path);
  return parse_camera_yaml(text, path);
}

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

ImportedCamera parse_camera_yaml(std::string_view text, const std::string& name) {
  return CameraYaml(text, name).read();
}

std::vector<ConfigValue> camera_values(const geometry::CameraIntrinsics& camera) {
  const auto numbers = [](const auto& array, int num_decimals) {
    return config_numbers({array.begin(), array.end()}, num_decimals);
  };
  return {{"camera.width_px", std::to_string(camera.width_px)},
          {"camera.height_px", std::to_string(camera.height_px)},
          {"camera.fc_px", numbers(camera.fc_px, 3)},
          {"camera.cc_px", numbers(camera.cc_px, 3)},
          {"camera.alpha_c", fixed_text(camera.alpha_c, 6)},
          {"camera.kc", numbers(camera.kc, 6)}};
}

}  // namespace orchard::io

// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/camera_import.hpp"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

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
  return CameraYaml(text, path).read();
}

std::vector<ConfigValue> camera_values(const geometry::CameraIntrinsics& camera) {
  return {{"camera.width_px", std::to_string(camera.width_px)},
          {"camera.height_px", std::to_string(camera.height_px)},
          {"camera.fc_px", config_numbers(camera.fc_px, 3)},
          {"camera.cc_px", config_numbers(camera.cc_px, 3)},
          {"camera.alpha_c", fixed_text(camera.alpha_c, 6)},
          {"camera.kc", config_numbers(camera.kc, 6)}};
}

}  // namespace orchard::io

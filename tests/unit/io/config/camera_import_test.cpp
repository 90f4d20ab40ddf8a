// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/camera_import.hpp"

#include <gtest/gtest.h>

#include "unit/io/test_folder.hpp"

namespace orchard::io {
namespace {

const std::string kRos =
    "image_width: 640\n"
    "image_height: 480\n"
    "camera_name: head_camera\n"
    "camera_matrix:\n  rows: 3\n  cols: 3\n"
    "  data: [500.5, 0.0, 320.25, 0.0, 501.5, 240.75, 0.0, 0.0, 1.0]\n"
    "distortion_model: plumb_bob\n"
    "distortion_coefficients:\n  rows: 1\n  cols: 5\n"
    "  data: [0.1, -0.2, 0.001, -0.002, 0.0]\n"
    "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n";

const std::string kOpenCv =
    "%YAML:1.0\n---\n"
    "calibration_time: \"Sat 21 Nov 2026\"\n"
    "image_width: 640\nimage_height: 480\n"
    "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
    "   data: [ 5.0050000000000000e+02, 0., 3.2025000000000000e+02, 0.,\n"
    "       5.0150000000000000e+02, 2.4075000000000000e+02, 0., 0., 1. ]\n"
    "distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n"
    "   data: [ 1.0000000000000001e-01, -2.0000000000000001e-01, 1.e-03, -2.e-03, 0. ]\n"
    "avg_reprojection_error: 2.0e-01\n";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

ImportedCamera camera_of(const std::string& text) {
  const TestFolder folder;
  return read_camera_file(folder.file("camera.file", text));
}

/// The sentence with which a text is refused.
std::string refusal(const std::string& text) {
  return refusal_of([&] { camera_of(text); });
}

TEST(CameraImport, ReadsRosAndOpenCvAlike) {
  for (const std::string& text : {kRos, kOpenCv, with(kRos, "distortion_model: plumb_bob\n", "")}) {
    const ImportedCamera camera = camera_of(text);
    EXPECT_EQ(camera.intrinsics.width_px, 640);
    EXPECT_EQ(camera.intrinsics.height_px, 480);
    EXPECT_EQ(camera.intrinsics.fc_px, (std::array<double, 2>{500.5, 501.5}));
    EXPECT_EQ(camera.intrinsics.cc_px, (std::array<double, 2>{320.25, 240.75}));
    EXPECT_EQ(camera.intrinsics.kc, (std::array<double, 5>{0.1, -0.2, 0.001, -0.002, 0.0}));
    EXPECT_EQ(camera.intrinsics.alpha_c, 0.0);
  }
  EXPECT_EQ(camera_of(kOpenCv).kind, "an OpenCV camera YAML");
}

TEST(CameraImport, TakesAPolynomialOnlyWhenItIsNone) {
  const std::string eight = with(with(kRos, "plumb_bob", "rational_polynomial"),
                                 "0.001, -0.002, 0.0]", "0.001, -0.002, 0.0, 0, 0, 0]");
  EXPECT_EQ(camera_of(eight).intrinsics.kc[1], -0.2);
  EXPECT_NE(refusal(with(eight, "0.0, 0, 0, 0]", "0.0, 0.1, 0, 0]")).find("more than the five"),
            std::string::npos);
}

TEST(CameraImport, RefusesYamlThatIsNoSuchCamera) {
  for (const auto& [from, to, words] : std::vector<std::array<std::string, 3>>{
           {"plumb_bob", "equidistant", "distortion_model is equidistant"},
           {"image_width: 640", "image_width: many", "image_width is not a number"},
           {"image_width: 640", "image_width: -1", "image_width is not a number"},
           {"image_height: 480\n", "", "has no image_height"},
           {"camera_matrix:", "matrix:", "has no camera_matrix"},
           {"[500.5, 0.0,", "[500.5,", "8 numbers instead of 9"},
           {"[500.5,", "[.nan,", "not a finite number"},
           {"[500.5,", "[-500.5,", "is not [fx s cx"},
           {"0.0, 0.0, 1.0]", "0.0, 0.5, 1.0]", "is not [fx s cx"},
           {"[0.1, -0.2,", "[0.1,", ""},
           {"[0.1, -0.2, 0.001, -0.002, 0.0]", "[0.1]", "are 1 numbers"},
           {"camera_name: head_camera", "fisheye_model: 1", "fisheye"},
           {"camera_name: head_camera", "camera_name: [", "is not valid YAML"}}) {
    const std::string sentence = refusal(with(kRos, from, to));
    if (!words.empty()) {
      EXPECT_NE(sentence.find(words), std::string::npos) << to << ": " << sentence;
    }
  }
  for (const char* text : {"", "3", "[1, 2]", "%YAML:1.0", "%YAML:1.0\n---\n- 1\n"}) {
    EXPECT_NE(refusal(text), "") << text;
  }
}

}  // namespace
}  // namespace orchard::io

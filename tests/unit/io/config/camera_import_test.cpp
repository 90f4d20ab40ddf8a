// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/camera_import.hpp"

#include <gtest/gtest.h>

#include "io/file_error.hpp"

namespace orchard::io {
namespace {

// As saving_calib.m of Bouguet's toolbox writes it.
const std::string kBouguet =
    "% Intrinsic and Extrinsic Camera Parameters\n"
    "%\n"
    "%-- Focal length:\n"
    "fc = [ 657.395366400276430 ; 657.763128034706360 ];\n"
    "\n"
    "%-- Principal point:\n"
    "cc = [ 302.983669002159490 ; 242.616307213742240 ];\n"
    "\n"
    "%-- Skew coefficient:\n"
    "alpha_c = 0.000420000000000;\n"
    "\n"
    "%-- Distortion coefficients:\n"
    "kc = [ -0.255838211 ; 0.127572222 ; -0.000208 ; 0.000033 ; 0.000000000000000 ];\n"
    "\n"
    "%-- Focal length uncertainty:\n"
    "fc_error = [ 0.346906 ; 0.371098 ];\n"
    "%-- Principal point uncertainty:\n"
    "cc_error = [ 0.705 ; 0.645 ];\n"
    "%-- Image size:\n"
    "nx = 640;\n"
    "ny = 480;\n"
    "%-- Various other variables (may be ignored if you do not use the Matlab Calibration "
    "Toolbox):\n"
    "n_ima = 20;\t\t\t\t\t\t% Number of calibration images\n"
    "est_dist = [ 1 ; 1 ; 1 ; 1 ; 0 ];\t\t\t\t\t% Selection indicator\n"
    "omc_1 = [ 1.654e+00 ; 1.651e+00 ; -6.699e-01 ];\n";

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

/// The sentence with which a text is refused.
template <class Parse>
std::string refusal(Parse parse, const std::string& text) {
  try {
    parse(text, "camera.file");
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

TEST(CameraImport, ReadsBouguetsResults) {
  const ImportedCamera camera = parse_camera_matlab(kBouguet, "Calib_Results.m");
  EXPECT_EQ(camera.intrinsics.width_px, 640);
  EXPECT_EQ(camera.intrinsics.height_px, 480);
  EXPECT_DOUBLE_EQ(camera.intrinsics.fc_px[0], 657.395366400276430);
  EXPECT_DOUBLE_EQ(camera.intrinsics.fc_px[1], 657.763128034706360);
  EXPECT_DOUBLE_EQ(camera.intrinsics.cc_px[1], 242.616307213742240);
  EXPECT_DOUBLE_EQ(camera.intrinsics.alpha_c, 0.00042);
  EXPECT_DOUBLE_EQ(camera.intrinsics.kc[0], -0.255838211);
  EXPECT_DOUBLE_EQ(camera.intrinsics.kc[3], 0.000033);
  ASSERT_TRUE(camera.fc_sd_px && camera.cc_sd_px);
  EXPECT_DOUBLE_EQ((*camera.fc_sd_px)[0], 0.346906 / 3.0);  // the file has three deviations
  EXPECT_DOUBLE_EQ((*camera.cc_sd_px)[1], 0.645 / 3.0);
}

TEST(CameraImport, ReadsMatlabAsPeopleWriteIt) {
  const ImportedCamera camera = parse_camera_matlab(
      "fc=[+6.0e2 6.1e2]; cc = [ 300,\n 200 ]\nkc = [0;0;0;0;0]; nx=640;ny=480 % fc = [1;1];\n"
      "% cc = [ 0 ; 0 ];\nlabel = 'a = [b';",
      "x.m");
  EXPECT_DOUBLE_EQ(camera.intrinsics.fc_px[1], 610.0);
  EXPECT_DOUBLE_EQ(camera.intrinsics.cc_px[1], 200.0);
  EXPECT_EQ(camera.intrinsics.alpha_c, 0.0);
  EXPECT_FALSE(camera.fc_sd_px);
}

TEST(CameraImport, RefusesMatlabThatIsNoCamera) {
  const auto parse = parse_camera_matlab;
  for (const auto& [from, to, words] : std::vector<std::array<std::string, 3>>{
           {"fc = [ 657.395366400276430 ;", "fc = [ ", "\"fc\""},
           {"cc =", "c =", "\"cc\""},
           {"; 0.000033 ;", ";", "\"kc\""},
           {"nx = 640", "nx = 640.5", "whole pixels"},
           {"nx = 640", "nx = 1e300", "whole pixels"},
           {"nx = 640", "nx = -640", "whole pixels"},
           {"ny = 480", "ny = nan", "\"ny\""},
           {"ny = 480", "ny = [480", "\"ny\""}}) {
    EXPECT_NE(refusal(parse, with(kBouguet, from, to)).find(words), std::string::npos) << to;
  }
  for (const std::string& text :
       {std::string(), std::string(100'000, '['), std::string(100'000, '='),
        "fc = [" + std::string(100'000, '1'), std::string("fc\0=", 4)}) {
    EXPECT_NE(refusal(parse, text), "");
  }
}

TEST(CameraImport, ReadsRosAndOpenCvAlike) {
  for (const std::string& text : {kRos, kOpenCv, with(kRos, "distortion_model: plumb_bob\n", "")}) {
    const ImportedCamera camera = parse_camera_yaml(text, "camera.yaml");
    EXPECT_EQ(camera.intrinsics.width_px, 640);
    EXPECT_EQ(camera.intrinsics.height_px, 480);
    EXPECT_EQ(camera.intrinsics.fc_px, (std::array<double, 2>{500.5, 501.5}));
    EXPECT_EQ(camera.intrinsics.cc_px, (std::array<double, 2>{320.25, 240.75}));
    EXPECT_EQ(camera.intrinsics.kc, (std::array<double, 5>{0.1, -0.2, 0.001, -0.002, 0.0}));
    EXPECT_EQ(camera.intrinsics.alpha_c, 0.0);
  }
  EXPECT_EQ(parse_camera_yaml(kOpenCv, "x").kind, "an OpenCV camera YAML");
}

TEST(CameraImport, TakesAPolynomialOnlyWhenItIsNone) {
  const std::string eight = with(with(kRos, "plumb_bob", "rational_polynomial"),
                                 "0.001, -0.002, 0.0]", "0.001, -0.002, 0.0, 0, 0, 0]");
  EXPECT_EQ(parse_camera_yaml(eight, "x").intrinsics.kc[1], -0.2);
  EXPECT_NE(refusal(parse_camera_yaml, with(eight, "0.0, 0, 0, 0]", "0.0, 0.1, 0, 0]"))
                .find("more than the five"),
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
    const std::string sentence = refusal(parse_camera_yaml, with(kRos, from, to));
    if (!words.empty()) {
      EXPECT_NE(sentence.find(words), std::string::npos) << to << ": " << sentence;
    }
  }
  for (const char* text : {"", "3", "[1, 2]", "%YAML:1.0", "%YAML:1.0\n---\n- 1\n"}) {
    EXPECT_NE(refusal(parse_camera_yaml, text), "") << text;
  }
}

}  // namespace
}  // namespace orchard::io

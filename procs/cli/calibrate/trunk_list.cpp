// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/trunk_list.hpp"

#include <fmt/core.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "io/atomic_file.hpp"
#include "io/folder.hpp"

namespace orchard::cli {
namespace {

constexpr int kPictureHeight_px = 160;

/// The nearest observation that has a picture, or none.
const calibration::TrunkObservation* best_observation(
    const calibration::ObservedObject& object,
    const std::vector<calibration::TrunkObservation>& observations) {
  const calibration::TrunkObservation* best = nullptr;
  for (const std::size_t i : object.observations) {
    if (observations[i].crop.area.empty()) continue;
    if (!best || observations[i].range_m < best->range_m) best = &observations[i];
  }
  return best;
}

void write_picture(const std::string& path, const vision::PixelBlock& crop) {
  const cv::Mat pixels(crop.area.height_px, crop.area.width_px, CV_8UC3,
                       const_cast<std::uint8_t*>(crop.bgr.data()));
  cv::Mat large;
  const double scale = static_cast<double>(kPictureHeight_px) / crop.area.height_px;
  cv::resize(pixels, large, {}, scale, scale, cv::INTER_NEAREST);
  std::vector<std::uint8_t> png;
  cv::imencode(".png", large, png);
  io::write_file_atomically(path, std::string(png.begin(), png.end()));
}

/// Formats an object; `format` has placeholders for its properties in this order.
std::string row(const char* format, int number, const calibration::ObservedObject& t) {
  return fmt::format(fmt::runtime(format), number, calibration::class_name(t), t.log + 1, t.x_m,
                     t.y_m, t.num_observations, 1e3 * t.median_width_m, t.dominant_hue_deg);
}

}  // namespace

void write_trunk_list(const std::string& folder, const calibration::TrunkModel& model,
                      const std::vector<calibration::TrunkObservation>& observations) {
  io::make_folder(folder, "choose another folder with --list");
  std::string csv = "number,taken_for,log,x_m,y_m,looks,width_mm,hue_deg\n";
  std::string html =
      "<!doctype html>\n"
      "<meta charset=\"utf-8\">\n"
      "<title>Objects found</title>\n"
      "<style>body{font-family:sans-serif}table{border-collapse:collapse}td,th{border:1px solid "
      "#ccc;padding:4px 10px;text-align:right}tr.trunk{background:#e4f4e0}</style>\n"
      "<h1>Objects found</h1>\n"
      "<p>Choose the trunks by their numbers: <code>--trees 3,7,9-20</code>. Green rows were "
      "classified as trunks.</p>\n"
      "<table>\n"
      "<tr><th>number</th><th>class</th><th>log</th><th>x (m)</th><th>y "
      "(m)</th><th>observations</th><th>width (mm)</th><th>hue (deg)</th><th>nearest "
      "observation</th></tr>\n";
  int number = 0;
  for (const calibration::ObservedObject& object : model.objects) {
    ++number;
    csv += row("{},{},{},{:.3f},{:.3f},{},{:.1f},{:.1f}\n", number, object);
    html += object.is_trunk ? "<tr class=\"trunk\">" : "<tr>";
    html +=
        row("<td>{}</td><td>{}</td><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{}</td>"
            "<td>{:.0f}</td><td>{:.0f}</td>",
            number, object);
    if (const auto* best = best_observation(object, observations)) {
      const std::string name = "thing_" + std::to_string(number) + ".png";
      write_picture(folder + "/" + name, best->crop);
      html += "<td><img src=\"" + name + "\" alt=\"object " + std::to_string(number) + "\"></td>";
    } else {
      html += "<td></td>";
    }
    html += "</tr>\n";
  }
  io::write_file_atomically(folder + "/things.csv", csv);
  io::write_file_atomically(folder + "/index.html", html + "</table>\n");
}

}  // namespace orchard::cli

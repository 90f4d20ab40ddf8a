// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "io/figure/canvas.hpp"
#include "io/file_error.hpp"

namespace orchard::io {
namespace {

constexpr int kShift = 4;  // OpenCV's fixed point for places between pixels

cv::Point fixed(PixelPoint p) {
  const double scale = 1 << kShift;
  return {static_cast<int>(std::lround(p.x * scale)), static_cast<int>(std::lround(p.y * scale))};
}

cv::Scalar bgr(Colour c) { return cv::Scalar(c.b, c.g, c.r); }

int thickness(double width) { return std::max(1, static_cast<int>(std::lround(width))); }

class PngCanvas : public Canvas {
 public:
  PngCanvas(int width_px, int height_px)
      : image_(height_px, width_px, CV_8UC3, cv::Scalar(255, 255, 255)) {}

  void line(PixelPoint from, PixelPoint to, Colour colour, double width) override {
    cv::line(image_, fixed(from), fixed(to), bgr(colour), thickness(width), cv::LINE_AA, kShift);
  }

  void polyline(const std::vector<PixelPoint>& points, Colour colour, double width) override {
    for (std::size_t i = 1; i < points.size(); ++i) line(points[i - 1], points[i], colour, width);
  }

  void circle(PixelPoint centre, double radius, Colour fill, Colour stroke) override {
    const int r = static_cast<int>(std::lround(radius * (1 << kShift)));
    cv::circle(image_, fixed(centre), r, bgr(fill), cv::FILLED, cv::LINE_AA, kShift);
    cv::circle(image_, fixed(centre), r, bgr(stroke), 1, cv::LINE_AA, kShift);
  }

  void text(PixelPoint position, const std::string& text, double size, Colour colour,
            TextAnchor anchor) override {
    constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
    const double scale = size / 30.0;  // its capitals are 22 pixels high at scale 1
    int base_line = 0;
    const cv::Size extent = cv::getTextSize(text, kFont, scale, 1, &base_line);
    double x = position.x;
    if (anchor == TextAnchor::kMiddle) x -= 0.5 * extent.width;
    if (anchor == TextAnchor::kEnd) x -= extent.width;
    cv::putText(image_, text,
                {static_cast<int>(std::lround(x)), static_cast<int>(std::lround(position.y))},
                kFont, scale, bgr(colour), 1, cv::LINE_AA);
  }

  std::string bytes() const override {
    std::vector<std::uint8_t> png;
    if (!cv::imencode(".png", image_, png)) throw FileError("map.png: OpenCV cannot encode it");
    return std::string(png.begin(), png.end());
  }

 private:
  cv::Mat image_;
};

}  // namespace

std::unique_ptr<Canvas> make_png_canvas(int width_px, int height_px) {
  return std::make_unique<PngCanvas>(width_px, height_px);
}

}  // namespace orchard::io

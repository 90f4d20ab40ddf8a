// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/canvas.hpp"
#include "io/fixed_text.hpp"

namespace orchard::io {
namespace {

std::string number(double value) { return fixed_text(value, 2); }

std::string rgb(Colour c) {
  return "rgb(" + std::to_string(c.r) + "," + std::to_string(c.g) + "," + std::to_string(c.b) + ")";
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '&')
      result += "&amp;";
    else
      result += c;
  }
  return result;
}

class SvgCanvas : public Canvas {
 public:
  SvgCanvas(int width_px, int height_px) {
    const std::string width = std::to_string(width_px);
    const std::string height = std::to_string(height_px);
    text_ = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + width + "\" height=\"" + height +
            "\" viewBox=\"0 0 " + width + " " + height +
            "\" font-family=\"sans-serif\">\n<rect width=\"100%\" height=\"100%\" "
            "fill=\"white\"/>\n";
  }

  void line(PixelPoint from, PixelPoint to, Colour colour, double width) override {
    text_ += "<line x1=\"" + number(from.x) + "\" y1=\"" + number(from.y) + "\" x2=\"" +
             number(to.x) + "\" y2=\"" + number(to.y) + "\" stroke=\"" + rgb(colour) +
             "\" stroke-width=\"" + number(width) + "\"/>\n";
  }

  void polyline(const std::vector<PixelPoint>& points, Colour colour, double width) override {
    text_ += "<polyline fill=\"none\" stroke=\"" + rgb(colour) + "\" stroke-width=\"" +
             number(width) + "\" points=\"";
    for (std::size_t i = 0; i < points.size(); ++i) {
      text_ += (i == 0 ? "" : " ") + number(points[i].x) + "," + number(points[i].y);
    }
    text_ += "\"/>\n";
  }

  void circle(PixelPoint centre, double radius, Colour fill, Colour stroke) override {
    text_ += "<circle cx=\"" + number(centre.x) + "\" cy=\"" + number(centre.y) + "\" r=\"" +
             number(radius) + "\" fill=\"" + rgb(fill) + "\" stroke=\"" + rgb(stroke) + "\"/>\n";
  }

  void text(PixelPoint position, const std::string& text, double size, Colour colour,
            TextAnchor anchor) override {
    const char* names[] = {"start", "middle", "end"};
    text_ += "<text x=\"" + number(position.x) + "\" y=\"" + number(position.y) +
             "\" font-size=\"" + number(size) + "\" fill=\"" + rgb(colour) + "\" text-anchor=\"" +
             names[static_cast<int>(anchor)] + "\">" + escaped(text) + "</text>\n";
  }

  std::string bytes() const override { return text_ + "</svg>\n"; }

 private:
  std::string text_;
};

}  // namespace

std::unique_ptr<Canvas> make_svg_canvas(int width_px, int height_px) {
  return std::make_unique<SvgCanvas>(width_px, height_px);
}

}  // namespace orchard::io

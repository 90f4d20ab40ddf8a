// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace orchard::io {

struct Colour {
  std::uint8_t r = 0, g = 0, b = 0;
};

struct PixelPoint {
  double x = 0.0;  ///< to the right
  double y = 0.0;  ///< down
};

enum class TextAnchor { kStart, kMiddle, kEnd };

/// What a figure is drawn on; all lengths in pixels.
class Canvas {
 public:
  virtual ~Canvas() = default;
  virtual void line(PixelPoint from, PixelPoint to, Colour colour, double width) = 0;
  virtual void polyline(const std::vector<PixelPoint>& points, Colour colour, double width) = 0;
  virtual void circle(PixelPoint centre, double radius, Colour fill, Colour stroke) = 0;
  /// `position` is on the text's base line. ASCII only.
  virtual void text(PixelPoint position, const std::string& text, double size, Colour colour,
                    TextAnchor anchor) = 0;
  /// The finished file.
  virtual std::string bytes() const = 0;
};

std::unique_ptr<Canvas> make_svg_canvas(int width_px, int height_px);
std::unique_ptr<Canvas> make_png_canvas(int width_px, int height_px);

}  // namespace orchard::io

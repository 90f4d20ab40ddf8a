// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace orchard::io {

/// Restricts text to characters of the figures' font: printable ASCII, Latin letters and common
/// signs of UTF-8 are kept; other characters and invalid UTF-8 bytes become '?'.
std::string drawn_text(std::string_view text);

struct Colour {
  std::uint8_t r = 0, g = 0, b = 0;
};

inline constexpr Colour kWhite{255, 255, 255};

struct PixelPoint {
  double x = 0.0;  ///< to the right
  double y = 0.0;  ///< down
};

struct PixelBox {
  double x0, y0, x1, y1;
  double width() const { return x1 - x0; }
  double height() const { return y1 - y0; }
};

enum class FigureFormat { kSvg, kPng, kPdf };

/// File format by the extension .svg, .png or .pdf. Throws FileError for another one.
FigureFormat figure_format(const std::string& path);

enum class TextAnchor { kStart, kMiddle, kEnd };

struct TextStyle {
  double size_px = 14.0;
  Colour colour{};
  TextAnchor anchor = TextAnchor::kStart;
  bool is_bold = false;
  bool is_upward = false;               ///< rotated, reads from bottom to top
  std::optional<Colour> halo_colour{};  ///< outline that keeps the text readable on lines
};

/// Width of a text, the same in every format.
double text_width_px(const std::string& text, double size_px, bool is_bold = false);

/// A page to draw on; the same calls give SVG, PNG or PDF. All lengths are in pixels of 1/96 inch.
/// Shapes with non-finite coordinates or far off the page are not drawn. Equal calls give equal
/// bytes on one machine.
class Canvas {
 public:
  /// Throws FileError for an invalid page size (more than 30,000 pixels, or none).
  Canvas(FigureFormat format, int width_px, int height_px, Colour background = kWhite);
  ~Canvas();

  void line(PixelPoint from, PixelPoint to, Colour colour, double width);
  void polyline(const std::vector<PixelPoint>& points, Colour colour, double width,
                bool is_dashed = false);
  void polygon(const std::vector<PixelPoint>& points, std::optional<Colour> fill,
               std::optional<Colour> stroke, double width = 1.0);
  void rectangle(const PixelBox& box, std::optional<Colour> fill, std::optional<Colour> stroke,
                 double width = 1.0);
  void circle(PixelPoint centre, double radius, Colour fill, Colour stroke);
  /// `position` is on the text's baseline. Characters that drawn_text() does not keep are drawn as
  /// '?'.
  void text(PixelPoint position, const std::string& text, const TextStyle& style);
  /// Draws an image stretched to the box without smoothing. `bgr`: rows of three bytes per pixel.
  void image(const PixelBox& box, const std::vector<std::uint8_t>& bgr, int width_px,
             int height_px);

  /// Draws what `draw` draws on this canvas as one picture of the box if so many signs, of at least
  /// this radius, cover it more than once: an SVG or a PDF of single shapes would show no more, and
  /// take kilobytes of memory for each.
  void signs(std::size_t num, double radius_px, const PixelBox& box,
             const std::function<void()>& draw);

  /// Sets the creation date of a PDF, "2026-11-22"; empty: the same constant date in every PDF.
  void set_day(const std::string& day);

  /// Returns the finished file; nothing can be drawn afterwards. Throws FileError.
  std::string finish();

 private:
  struct Page;
  std::unique_ptr<Page> page_;
};

}  // namespace orchard::io

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace orchard::io {

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

/// By the ending of a file's name: .svg, .png or .pdf. Throws FileError at another one.
FigureFormat figure_format(const std::string& path);

enum class TextAnchor { kStart, kMiddle, kEnd };

struct TextStyle {
  double size_px = 14.0;
  Colour colour{};
  TextAnchor anchor = TextAnchor::kStart;
  bool is_bold = false;
  bool is_upward = false;               ///< read from below
  std::optional<Colour> halo_colour{};  ///< an outline that keeps it readable on lines
};

/// How far a text runs, the same on every canvas.
double text_width_px(const std::string& text, double size_px, bool is_bold = false);

/// A page that a figure is drawn on: the same calls give SVG, PNG or PDF. All lengths in pixels of
/// 1/96 inch. What is not finite or far off the page is not drawn. Equal calls give equal bytes on
/// one machine.
class Canvas {
 public:
  /// Throws FileError where there is no such page (of more than 30,000 pixels, or none).
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
  /// `position` is on the text's base line. What drawn_text() does not keep is drawn as '?'.
  void text(PixelPoint position, const std::string& text, const TextStyle& style);
  /// A picture stretched over the box without smoothing. `bgr`: rows of three bytes a pixel.
  void image(const PixelBox& box, const std::vector<std::uint8_t>& bgr, int width_px,
             int height_px);

  /// What is drawn until end_inset() has its origin there and is so much larger.
  void begin_inset(PixelPoint origin, double scale);
  void end_inset();

  /// The day that a PDF says it was made on, "2026-11-22"; empty: the same one in every PDF.
  void set_day(const std::string& day);

  /// What is drawn from now on stands on a new page. Throws FileError where there is only one.
  void next_page();

  /// The finished file; nothing can be drawn afterwards. Throws FileError.
  std::string finish();

 private:
  struct Page;
  std::unique_ptr<Page> page_;
};

}  // namespace orchard::io

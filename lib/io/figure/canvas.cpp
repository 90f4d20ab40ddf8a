// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/canvas.hpp"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <png.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <utility>
#include <vector>

#include "geometry/angles.hpp"
#include "io/file_error.hpp"

namespace orchard::io {
namespace {

unsigned byte_at(std::string_view text, std::size_t i) {
  return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
}

bool continues(unsigned byte) { return (byte & 0xC0u) == 0x80u; }

/// Number of bytes of the UTF-8 character that begins here; 0 if none does.
std::size_t length_at(std::string_view text, std::size_t i) {
  const unsigned first = byte_at(text, i), second = byte_at(text, i + 1),
                 third = byte_at(text, i + 2);
  if (first < 0x80u) return 1;
  if (first >= 0xC2u && first < 0xE0u && continues(second)) return 2;
  const bool is_shortest = first != 0xE0u || second >= 0xA0u;
  if (first >= 0xE0u && first < 0xF0u && is_shortest && continues(second) && continues(third)) {
    return 3;
  }
  return first >= 0xF0u && first < 0xF5u && continues(second) && continues(third) &&
                 continues(byte_at(text, i + 3))
             ? 4
             : 0;
}

/// Whether DejaVu Sans has the character: Latin letters, dashes, quotes and arithmetic signs.
bool is_drawn(std::string_view character) {
  const unsigned first = byte_at(character, 0), second = byte_at(character, 1),
                 third = byte_at(character, 2);
  if (character.size() == 1) return first >= ' ' && first <= '~';
  if (character.size() == 2) {
    const unsigned code = (first & 0x1Fu) << 6 | (second & 0x3Fu);
    return code >= 0xA1u && code < 0x250u && code != 0xADu;  // the soft hyphen is not drawn
  }
  if (character.size() != 3) return false;
  const unsigned code = (first & 0x0Fu) << 12 | (second & 0x3Fu) << 6 | (third & 0x3Fu);
  return (code >= 0x2010u && code < 0x2028u) || (code >= 0x2190u && code < 0x2300u);
}

constexpr int kSizeMaxPx = 30000;         // cairo's images end at 32767
constexpr double kCoordinateMaxPx = 1e6;  // cairo's fixed-point numbers end at 8e6
constexpr double kPointsPerPx = 0.75;     // PDF uses units of 1/72 inch
constexpr double kDashPx[] = {4.0, 3.0};
constexpr double kHaloPx = 3.0;
// derived: of a picture in place of shapes; 192 dpi on paper, where a sign is ten pixels wide.
constexpr double kPicturePerPx = 2.0;
constexpr const char* kFont = "DejaVu Sans";
// PDF requires a date; the current time would make every file different.
constexpr const char* kPdfDate = "2000-01-01T00:00:00Z";

struct FontOptions {
  FontOptions() {
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  }
  ~FontOptions() { cairo_font_options_destroy(options); }
  cairo_font_options_t* options = cairo_font_options_create();
};

bool is_drawable(PixelPoint p) {
  return std::abs(p.x) < kCoordinateMaxPx && std::abs(p.y) < kCoordinateMaxPx;  // false for NaN
}

cairo_font_weight_t weight_of(bool is_bold) {
  return is_bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL;
}

cairo_status_t append(void* file, const unsigned char* data, unsigned int size) {
  static_cast<std::string*>(file)->append(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;
}

/// The picture of a surface as a PNG. cairo's own writer tries every filter on every row, which
/// costs more than drawing a map.
std::string png_of(cairo_surface_t* surface) {
  cairo_surface_flush(surface);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.format = PNG_FORMAT_RGB;
  image.flags = PNG_IMAGE_FLAG_FAST;
  image.width = static_cast<png_uint_32>(cairo_image_surface_get_width(surface));
  image.height = static_cast<png_uint_32>(cairo_image_surface_get_height(surface));
  std::vector<std::uint8_t> rgb;
  rgb.reserve(std::size_t{3} * image.width * image.height);
  const unsigned char* row = cairo_image_surface_get_data(surface);
  for (png_uint_32 y = 0; y < image.height; ++y, row += cairo_image_surface_get_stride(surface)) {
    for (png_uint_32 x = 0; x < image.width; ++x) {
      std::uint32_t pixel;
      std::memcpy(&pixel, row + 4 * x, sizeof pixel);
      for (const int shift : {16, 8, 0}) rgb.push_back(static_cast<std::uint8_t>(pixel >> shift));
    }
  }
  std::string file(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = file.size();
  if (!png_image_write_to_memory(&image, file.data(), &size, 0, rgb.data(), 0, nullptr)) {
    throw SystemError(std::string("libpng: ") + image.message);
  }
  file.resize(size);
  return file;
}

/// cairo numbers the surfaces and images of a process and writes the numbers to the file as ids.
/// Renumbers them from 0, so that equal drawings give equal files.
std::string with_numbers_of_its_own(const std::string& svg) {
  std::map<std::string, std::size_t> numbers;  // by cairo's name
  std::string result;
  std::size_t done = 0;
  for (std::size_t i = svg.find_first_of("\"#"); i != std::string::npos;
       i = svg.find_first_of("\"#", i + 1)) {
    for (const std::string kind : {"surface", "image"}) {
      const std::size_t digits = i + 1 + kind.size();
      if (svg.compare(i + 1, kind.size(), kind) != 0) continue;
      const std::size_t end = svg.find_first_not_of("0123456789", digits);
      if (end == digits || end == std::string::npos) continue;
      const std::string name = svg.substr(i + 1, end - i - 1);
      const std::size_t number = numbers.try_emplace(name, numbers.size()).first->second;
      result += svg.substr(done, digits - done) + std::to_string(number);
      done = end;
    }
  }
  return result + svg.substr(done);
}

cairo_surface_t* make_surface(FigureFormat format, int width_px, int height_px, std::string* file) {
  switch (format) {
    case FigureFormat::kSvg: {
      cairo_surface_t* svg = cairo_svg_surface_create_for_stream(append, file, width_px, height_px);
      cairo_svg_surface_set_document_unit(svg, CAIRO_SVG_UNIT_PX);
      return svg;
    }
    case FigureFormat::kPdf: {
      cairo_surface_t* pdf = cairo_pdf_surface_create_for_stream(
          append, file, width_px * kPointsPerPx, height_px * kPointsPerPx);
      cairo_pdf_surface_set_metadata(pdf, CAIRO_PDF_METADATA_CREATE_DATE, kPdfDate);
      return pdf;
    }
    case FigureFormat::kPng:
      break;
  }
  return cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px);
}

}  // namespace

std::string drawn_text(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = length_at(text, i);
    const std::string_view character = text.substr(i, length);
    if (length > 0 && is_drawn(character)) {
      result += character;
    } else {
      result += '?';
    }
    i += length > 0 ? length : 1;
  }
  return result;
}

FigureFormat figure_format(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".svg") return FigureFormat::kSvg;
  if (extension == ".png") return FigureFormat::kPng;
  if (extension == ".pdf") return FigureFormat::kPdf;
  throw FileError(path + ": the name of a figure must end in .svg, .png or .pdf");
}

double text_width_px(const std::string& text, double size_px, bool is_bold) {
  const FontOptions font;
  cairo_matrix_t size, identity;
  cairo_matrix_init_scale(&size, size_px, size_px);
  cairo_matrix_init_identity(&identity);
  cairo_font_face_t* face =
      cairo_toy_font_face_create(kFont, CAIRO_FONT_SLANT_NORMAL, weight_of(is_bold));
  cairo_scaled_font_t* scaled = cairo_scaled_font_create(face, &size, &identity, font.options);
  cairo_text_extents_t extents{};
  cairo_scaled_font_text_extents(scaled, drawn_text(text).c_str(), &extents);
  cairo_scaled_font_destroy(scaled);
  cairo_font_face_destroy(face);
  return extents.x_advance;
}

struct Canvas::Page {
  Page(FigureFormat of, int width_px, int height_px)
      : format(of),
        surface(make_surface(of, width_px, height_px, &file)),
        cairo(cairo_create(surface)) {
    const FontOptions font;
    cairo_set_font_options(cairo, font.options);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    if (format == FigureFormat::kPdf) cairo_scale(cairo, kPointsPerPx, kPointsPerPx);
  }
  ~Page() {
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
  }
  Page(const Page&) = delete;

  void set(Colour c) { cairo_set_source_rgb(cairo, c.r / 255.0, c.g / 255.0, c.b / 255.0); }

  /// Fills and strokes the current path.
  void paint(std::optional<Colour> fill, std::optional<Colour> stroke, double width) {
    if (fill) {
      set(*fill);
      cairo_fill_preserve(cairo);
    }
    if (stroke) {
      set(*stroke);
      cairo_set_line_width(cairo, width);
      cairo_stroke_preserve(cairo);
    }
    cairo_new_path(cairo);
  }

  /// Adds a path through the points; starts a new part after each point that cannot be drawn.
  void lay(const std::vector<PixelPoint>& points) {
    cairo_new_path(cairo);
    bool is_begun = false;
    for (const PixelPoint& p : points) {
      if (!is_drawable(p)) {
        is_begun = false;
      } else if (is_begun) {
        cairo_line_to(cairo, p.x, p.y);
      } else {
        cairo_move_to(cairo, p.x, p.y);
        is_begun = true;
      }
    }
  }

  void check() const {
    cairo_status_t status = cairo_status(cairo);
    if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface);
    if (status != CAIRO_STATUS_SUCCESS) {
      throw SystemError(std::string("a figure cannot be drawn: ") + cairo_status_to_string(status));
    }
  }

  FigureFormat format;
  std::string file;
  cairo_surface_t* surface;
  cairo_t* cairo;
};

Canvas::Canvas(FigureFormat format, int width_px, int height_px, Colour background) {
  if (width_px < 1 || height_px < 1 || width_px > kSizeMaxPx || height_px > kSizeMaxPx) {
    throw FileError("a figure of " + std::to_string(width_px) + " by " + std::to_string(height_px) +
                    " pixels cannot be drawn");
  }
  page_ = std::make_unique<Page>(format, width_px, height_px);
  page_->set(background);
  cairo_paint(page_->cairo);
}

Canvas::~Canvas() = default;

void Canvas::line(PixelPoint from, PixelPoint to, Colour colour, double width) {
  polyline({from, to}, colour, width);
}

void Canvas::polyline(const std::vector<PixelPoint>& points, Colour colour, double width,
                      bool is_dashed) {
  page_->lay(points);
  if (is_dashed) cairo_set_dash(page_->cairo, kDashPx, 2, 0.0);
  page_->paint({}, colour, width);
  cairo_set_dash(page_->cairo, nullptr, 0, 0.0);
}

void Canvas::polygon(const std::vector<PixelPoint>& points, std::optional<Colour> fill,
                     std::optional<Colour> stroke, double width) {
  page_->lay(points);
  cairo_close_path(page_->cairo);
  page_->paint(fill, stroke, width);
}

void Canvas::rectangle(const PixelBox& box, std::optional<Colour> fill,
                       std::optional<Colour> stroke, double width) {
  polygon({{box.x0, box.y0}, {box.x1, box.y0}, {box.x1, box.y1}, {box.x0, box.y1}}, fill, stroke,
          width);
}

void Canvas::circle(PixelPoint centre, double radius, Colour fill, Colour stroke) {
  if (!is_drawable(centre) || !(radius > 0.0 && radius < kCoordinateMaxPx)) return;
  cairo_new_path(page_->cairo);
  cairo_arc(page_->cairo, centre.x, centre.y, radius, 0.0, 2.0 * geometry::kPi);
  cairo_close_path(page_->cairo);
  page_->paint(fill, stroke, 1.0);
}

void Canvas::text(PixelPoint position, const std::string& text, const TextStyle& style) {
  if (!is_drawable(position)) return;
  cairo_t* cairo = page_->cairo;
  const std::string drawn = drawn_text(text);
  const double fraction = style.anchor == TextAnchor::kStart    ? 0.0
                          : style.anchor == TextAnchor::kMiddle ? 0.5
                                                                : 1.0;
  cairo_save(cairo);
  cairo_select_font_face(cairo, kFont, CAIRO_FONT_SLANT_NORMAL, weight_of(style.is_bold));
  cairo_set_font_size(cairo, style.size_px);
  cairo_translate(cairo, position.x, position.y);
  if (style.is_upward) cairo_rotate(cairo, -0.5 * geometry::kPi);
  const double begin_px = -fraction * text_width_px(drawn, style.size_px, style.is_bold);
  if (style.halo_colour) {
    cairo_move_to(cairo, begin_px, 0.0);
    cairo_text_path(cairo, drawn.c_str());
    page_->paint({}, style.halo_colour, kHaloPx);
  }
  page_->set(style.colour);
  cairo_move_to(cairo, begin_px, 0.0);
  cairo_show_text(cairo, drawn.c_str());
  cairo_new_path(cairo);
  cairo_restore(cairo);
}

void Canvas::image(const PixelBox& box, const std::vector<std::uint8_t>& bgr, int width_px,
                   int height_px) {
  cairo_surface_t* picture = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px);
  const auto columns = static_cast<std::size_t>(width_px);
  if (cairo_surface_status(picture) != CAIRO_STATUS_SUCCESS ||
      bgr.size() != 3 * columns * static_cast<std::size_t>(height_px)) {
    cairo_surface_destroy(picture);
    throw FileError("a picture of " + std::to_string(width_px) + " by " +
                    std::to_string(height_px) + " pixels cannot be drawn");
  }
  cairo_surface_flush(picture);
  unsigned char* rows = cairo_image_surface_get_data(picture);
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(picture));
  for (std::size_t i = 0; i < columns * static_cast<std::size_t>(height_px); ++i) {
    const std::uint32_t pixel =
        bgr[3 * i] | std::uint32_t{bgr[3 * i + 1]} << 8 | std::uint32_t{bgr[3 * i + 2]} << 16;
    reinterpret_cast<std::uint32_t*>(rows + i / columns * stride)[i % columns] = pixel;
  }
  cairo_surface_mark_dirty(picture);
  cairo_t* cairo = page_->cairo;
  cairo_save(cairo);
  cairo_translate(cairo, box.x0, box.y0);
  cairo_scale(cairo, box.width() / width_px, box.height() / height_px);
  cairo_set_source_surface(cairo, picture, 0.0, 0.0);
  cairo_pattern_set_filter(cairo_get_source(cairo), CAIRO_FILTER_NEAREST);
  cairo_rectangle(cairo, 0.0, 0.0, width_px, height_px);
  cairo_fill(cairo);
  cairo_restore(cairo);
  cairo_surface_destroy(picture);
}

void Canvas::signs(std::size_t num, double radius_px, const PixelBox& box,
                   const std::function<void()>& draw) {
  const double covered_px2 = static_cast<double>(num) * geometry::kPi * radius_px * radius_px;
  if (page_->format == FigureFormat::kPng || covered_px2 < box.width() * box.height()) {
    return draw();
  }
  cairo_surface_t* picture =
      cairo_image_surface_create(CAIRO_FORMAT_ARGB32, std::lround(kPicturePerPx * box.width()),
                                 std::lround(kPicturePerPx * box.height()));
  cairo_surface_set_device_scale(picture, kPicturePerPx, kPicturePerPx);
  cairo_surface_set_device_offset(picture, -kPicturePerPx * box.x0, -kPicturePerPx * box.y0);
  cairo_t* page = std::exchange(page_->cairo, cairo_create(picture));
  cairo_set_line_join(page_->cairo, CAIRO_LINE_JOIN_ROUND);
  draw();
  page_->check();
  cairo_destroy(std::exchange(page_->cairo, page));
  cairo_set_source_surface(page_->cairo, picture, 0.0, 0.0);
  cairo_rectangle(page_->cairo, box.x0, box.y0, box.width(), box.height());
  cairo_fill(page_->cairo);
  cairo_surface_destroy(picture);
}

void Canvas::set_day(const std::string& day) {
  if (page_->format != FigureFormat::kPdf || day.empty()) return;
  cairo_pdf_surface_set_metadata(page_->surface, CAIRO_PDF_METADATA_CREATE_DATE,
                                 (day + "T00:00:00Z").c_str());
}

std::string Canvas::finish() {
  page_->check();
  if (page_->format == FigureFormat::kPng) {
    page_->file = png_of(page_->surface);
  } else {
    cairo_show_page(page_->cairo);
    cairo_surface_finish(page_->surface);
  }
  if (page_->file.empty()) page_->check();
  return page_->format == FigureFormat::kSvg ? with_numbers_of_its_own(page_->file)
                                             : std::move(page_->file);
}

}  // namespace orchard::io

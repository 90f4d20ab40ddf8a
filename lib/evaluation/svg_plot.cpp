// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/svg_plot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace orchard::evaluation {
namespace {

constexpr double kWidth = 460, kHeight = 330, kLeft = 56, kRight = 12, kTop = 30, kBottom = 44;
constexpr int kTicks = 5;
constexpr std::array<const char*, 7> kColours{"#1b7837", "#2166ac", "#b2182b", "#e08214",
                                              "#762a83", "#333333", "#01a0a0"};

std::string number(double value, int decimals = 1) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

struct Axes {
  const Plot& plot;
  double x(double value) const {
    const double share = (value - plot.x_min) / (plot.x_max - plot.x_min);
    return kLeft + std::clamp(share, 0.0, 1.0) * (kWidth - kLeft - kRight);
  }
  double y(double value) const {
    const double share = (value - plot.y_min) / (plot.y_max - plot.y_min);
    return kHeight - kBottom - std::clamp(share, 0.0, 1.0) * (kHeight - kTop - kBottom);
  }
};

std::string text_at(double x, double y, const std::string& text, const char* anchor,
                    const std::string& more = {}) {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\"" +
         more + ">" + escaped(text) + "</text>\n";
}

std::string line(double x1, double y1, double x2, double y2, const char* style) {
  return "<line x1=\"" + number(x1) + "\" y1=\"" + number(y1) + "\" x2=\"" + number(x2) +
         "\" y2=\"" + number(y2) + "\" " + style + "/>\n";
}

int decimals_of(double span) { return span <= 0.2 ? 3 : span <= 2.0 ? 2 : span <= 20.0 ? 1 : 0; }

std::string axes_svg(const Plot& plot, const Axes& axes) {
  std::string svg;
  for (int i = 0; i <= kTicks; ++i) {
    const double share = static_cast<double>(i) / kTicks;
    const double vx = plot.x_min + share * (plot.x_max - plot.x_min);
    const double vy = plot.y_min + share * (plot.y_max - plot.y_min);
    svg += line(axes.x(vx), axes.y(plot.y_min), axes.x(vx), axes.y(plot.y_max), "stroke=\"#eee\"");
    svg += line(axes.x(plot.x_min), axes.y(vy), axes.x(plot.x_max), axes.y(vy), "stroke=\"#eee\"");
    svg += text_at(axes.x(vx), kHeight - kBottom + 16,
                   number(vx, decimals_of(plot.x_max - plot.x_min)), "middle");
    svg +=
        text_at(kLeft - 6, axes.y(vy) + 4, number(vy, decimals_of(plot.y_max - plot.y_min)), "end");
  }
  svg += "<rect x=\"" + number(kLeft) + "\" y=\"" + number(kTop) + "\" width=\"" +
         number(kWidth - kLeft - kRight) + "\" height=\"" + number(kHeight - kTop - kBottom) +
         "\" fill=\"none\" stroke=\"#888\"/>\n";
  svg +=
      text_at(0.5 * (kLeft + kWidth - kRight), 18, plot.title, "middle", " font-weight=\"bold\"");
  svg += text_at(0.5 * (kLeft + kWidth - kRight), kHeight - 8, plot.x_label, "middle");
  const double middle = 0.5 * (kTop + kHeight - kBottom);
  svg += text_at(14, middle, plot.y_label, "middle",
                 " transform=\"rotate(-90 14 " + number(middle) + ")\"");
  return svg;
}

std::string series_svg(const PlotSeries& series, const Axes& axes, const std::string& colour) {
  std::string points, marks;
  for (const auto& [x, y] : series.points) {
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    const std::string px = number(axes.x(x)), py = number(axes.y(y));
    points += (points.empty() ? "" : " ") + px + "," + py;
    marks += "<circle cx=\"" + px + "\" cy=\"" + py + "\" r=\"3\" fill=\"" + colour + "\"/>\n";
  }
  std::string svg;
  if (series.has_line) {
    svg += "<polyline points=\"" + points + "\" fill=\"none\" stroke=\"" + colour + "\" " +
           (series.is_reference ? "stroke-dasharray=\"4 3\"" : "stroke-width=\"1.8\"") + "/>\n";
  }
  return series.has_marks ? svg + marks : svg;
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string svg_plot(const Plot& plot) {
  const Axes axes{plot};
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + number(kWidth, 0) +
                    "\" height=\"" + number(kHeight, 0) + "\" viewBox=\"0 0 " + number(kWidth, 0) +
                    " " + number(kHeight, 0) +
                    "\" font-family=\"sans-serif\" font-size=\"11\">\n"
                    "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  svg += axes_svg(plot, axes);
  std::size_t next_colour = 0;
  std::size_t num_named = 0;
  for (const PlotSeries& series : plot.series) num_named += series.name.empty() ? 0 : 1;
  double legend_y = kHeight - kBottom - 8 - 14.0 * static_cast<double>(num_named);
  for (const PlotSeries& series : plot.series) {
    const std::string colour =
        series.is_reference ? "#999999" : kColours[next_colour++ % kColours.size()];
    svg += series_svg(series, axes, colour);
    if (series.name.empty()) continue;
    legend_y += 14;
    svg += "<line x1=\"" + number(kLeft + 10) + "\" y1=\"" + number(legend_y - 4) + "\" x2=\"" +
           number(kLeft + 30) + "\" y2=\"" + number(legend_y - 4) + "\" stroke=\"" + colour +
           "\" stroke-width=\"2\"/>\n";
    svg += text_at(kLeft + 36, legend_y, series.name, "start");
  }
  return svg + "</svg>\n";
}

}  // namespace orchard::evaluation

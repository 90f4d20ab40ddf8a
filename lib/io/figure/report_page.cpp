// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/report_page.hpp"

#include "io/figure/plots_figure.hpp"
#include "text/markup_text.hpp"

namespace orchard::io {
namespace {

constexpr const char* kHead =
    "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<style>\n"
    "body{font-family:sans-serif;margin:2em;max-width:75em}\n"
    "pre{background:#f6f6f6;padding:1em;overflow-x:auto}\nsvg{max-width:100%;height:auto}\n"
    "</style>\n";

}  // namespace

std::string report_page(const std::string& title, const std::vector<evaluation::Plot>& plots,
                        const std::string& tables) {
  const std::string svg = plots_figure(plots, FigureFormat::kSvg);
  return kHead + ("<title>" + markup_text(title)) + "</title>\n</head>\n<body>\n<h1>" +
         markup_text(title) + "</h1>\n" + svg.substr(svg.find("<svg")) + "<pre>" +
         markup_text(tables) + "</pre>\n</body>\n</html>\n";
}

}  // namespace orchard::io

// SPDX-License-Identifier: BSD-3-Clause
#include "io/report/document.hpp"

#include <algorithm>

#include "text/encoded_text.hpp"

namespace orchard::io {
namespace {

constexpr const char* kStyle =
    "body{font:15px/1.45 'DejaVu Sans',system-ui,sans-serif;color:#222;max-width:52em;"
    "margin:2em auto;padding:0 1em}\n"
    "h1{font-size:1.6em;margin:0}h2{font-size:1.15em;margin:1.6em 0 .4em;"
    "border-bottom:1px solid #bbb}\n"
    ".subtitle{color:#555;margin:.2em 0 1.2em}p{margin:.4em 0}\n"
    "table{border-collapse:collapse;width:100%;font-size:.92em;"
    "font-variant-numeric:tabular-nums}\n"
    "th,td{text-align:right;padding:.18em .5em;border-bottom:1px solid #ddd;vertical-align:top}\n"
    "th{border-bottom:1px solid #777}.t{text-align:left}.sum td{font-weight:bold;"
    "border-top:1px solid #777}\n"
    "thead{display:table-header-group}tr{break-inside:avoid}figure{margin:.6em 0;"
    "break-inside:avoid}\n"
    "svg{max-width:100%;height:auto}@page{size:A4;margin:15mm}\n"
    "@media print{body{margin:0;max-width:none;font-size:11px}h2{break-after:avoid}}\n";

bool is_text(const DocumentTable& table, std::size_t column) {
  return column == 0 ||
         std::count(table.text_columns.begin(), table.text_columns.end(), column) > 0;
}

/// Prefixes the ids of a drawing with its number, because ids must be unique in the page.
std::string with_own_ids(const std::string& svg, std::size_t number) {
  const std::string prefix = "d" + std::to_string(number) + "-";
  std::string result;
  std::size_t done = 0;
  for (std::size_t i = 0; i < svg.size(); ++i) {
    for (const std::string mark : {" id=\"", "href=\"#", "url(#"}) {
      if (svg.compare(i, mark.size(), mark) != 0) continue;
      result += svg.substr(done, i + mark.size() - done) + prefix;
      done = i + mark.size();
      break;
    }
  }
  return result + svg.substr(done);
}

}  // namespace

Document::Document(const std::string& language, const std::string& title,
                   const std::string& subtitle)
    : html_("<!DOCTYPE html>\n<html lang=\"" + markup_text(language) +
            "\">\n<head>\n<meta charset=\"utf-8\">\n"
            "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
            "<meta http-equiv=\"Content-Security-Policy\" "
            "content=\"default-src 'none'; style-src 'unsafe-inline'; img-src data:\">\n<title>" +
            markup_text(title) + "</title>\n<style>\n" + kStyle +
            "</style>\n</head>\n<body>\n<main>\n<h1>" + markup_text(title) +
            "</h1>\n<p class=\"subtitle\">" + markup_text(subtitle) + "</p>\n") {}

void Document::add_heading(const std::string& text) {
  html_ += "<h2>" + markup_text(text) + "</h2>\n";
}

void Document::add_text(const std::string& text) { html_ += "<p>" + markup_text(text) + "</p>\n"; }

void Document::add_table(const DocumentTable& table) {
  html_ += "<table>\n<thead><tr>";
  for (std::size_t c = 0; c < table.head.size(); ++c) {
    html_ += std::string("<th") + (is_text(table, c) ? " class=\"t\"" : "") + " scope=\"col\">" +
             markup_text(table.head[c]) + "</th>";
  }
  html_ += "</tr></thead>\n<tbody>\n";
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    html_ += table.has_sum && r + 1 == table.rows.size() ? "<tr class=\"sum\">" : "<tr>";
    for (std::size_t c = 0; c < table.rows[r].size(); ++c) {
      html_ += std::string("<td") + (is_text(table, c) ? " class=\"t\"" : "") + ">" +
               markup_text(table.rows[r][c]) + "</td>";
    }
    html_ += "</tr>\n";
  }
  html_ += "</tbody>\n</table>\n";
}

void Document::add_figure(const std::string& svg) {
  const std::size_t begin = svg.find("<svg");
  if (begin == std::string::npos) return;
  html_ += "<figure>" + with_own_ids(svg.substr(begin), ++num_figures_) + "</figure>\n";
}

std::string Document::html() const { return html_ + "</main>\n</body>\n</html>\n"; }

}  // namespace orchard::io

// SPDX-License-Identifier: BSD-3-Clause
#include "view/page.hpp"

#include "text/encoded_text.hpp"
#include "view/page_parts.hpp"

namespace orchard::view {
namespace {

/// Escapes JSON for an HTML element, so that no string can close the element. In JSON, "<" occurs
/// only within strings, where the escape is equivalent.
std::string json_in_html(std::string_view json) {
  std::string escaped;
  escaped.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      escaped += "\\u003c";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

/// `title` and `data` as they stand in HTML.
std::string page_of(std::string_view title, std::string_view data, PageSource source) {
  std::string html;
  html.reserve(kPage.size() + kStyle.size() + kScript.size() + data.size() + 1024);
  std::string_view rest = kPage;
  for (std::size_t begin = rest.find("{{"); begin != rest.npos; begin = rest.find("{{")) {
    const std::size_t end = rest.find("}}", begin);
    const std::string_view name = rest.substr(begin + 2, end - begin - 2);
    html += rest.substr(0, begin);
    if (name == "POLICY") html += page_policy(source);
    if (name == "TITLE") html += title;
    if (name == "STYLE") html += kStyle;
    if (name == "SCRIPT") html += kScript;
    if (name == "DATA") html += data;
    rest.remove_prefix(end + 2);
  }
  return html.append(rest);
}

}  // namespace

std::string page_policy(PageSource source) {
  std::string policy = "default-src 'none'; script-src '" + std::string(kScriptSum) + "'";
  if (source == PageSource::kFileWithTiles) policy += " file:";
  policy += "; style-src '" + std::string(kStyleSum) + "'; img-src data:";
  if (source == PageSource::kFileWithTiles) policy += " file:";
  if (source == PageSource::kServer) policy += " 'self' blob:; connect-src 'self'";
  return policy + "; base-uri 'none'; form-action 'none'";
}

std::string page_html(std::string_view title, std::string_view data_json, PageSource source) {
  return page_of(markup_text(title), json_in_html(data_json), source);
}

std::string with_background(std::string_view html, std::string_view background_json) {
  constexpr std::string_view kData = R"(<script id="map-data" type="application/json">{)";
  constexpr std::string_view kBackground = "\"background\":{", kEnd = "\"},";
  constexpr std::string_view kTitle = "<title>", kTitleEnd = "</title>";
  const std::size_t head = html.find(kData), title = html.find(kTitle);
  if (head == html.npos || title > head) return {};
  std::size_t begin = head + kData.size();
  const std::size_t data_end = html.find("</script>", begin), title_end = html.find(kTitleEnd);
  if (data_end == html.npos || title_end > head) return {};
  // Neither numbers nor base 64 have the characters of its end.
  if (html.substr(begin, kBackground.size()) == kBackground) {
    const std::size_t end = html.find(kEnd, begin);
    if (end == html.npos || end > data_end) return {};
    begin = end + kEnd.size();
  }
  std::string data = "{";
  data.append(background_json).append(html.substr(begin, data_end - begin));
  const bool has_tiles = html.substr(0, head).find(" file:") != html.npos;
  const std::size_t words = title + kTitle.size();
  return page_of(html.substr(words, title_end - words), data,
                 has_tiles ? PageSource::kFileWithTiles : PageSource::kFile);
}

}  // namespace orchard::view

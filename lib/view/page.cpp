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
  std::string html;
  html.reserve(kPage.size() + kStyle.size() + kScript.size() + data_json.size() + 1024);
  std::string_view rest = kPage;
  for (std::size_t begin = rest.find("{{"); begin != rest.npos; begin = rest.find("{{")) {
    const std::size_t end = rest.find("}}", begin);
    const std::string_view name = rest.substr(begin + 2, end - begin - 2);
    html += rest.substr(0, begin);
    if (name == "POLICY") html += page_policy(source);
    if (name == "TITLE") html += markup_text(title);
    if (name == "STYLE") html += kStyle;
    if (name == "SCRIPT") html += kScript;
    if (name == "DATA") html += json_in_html(data_json);
    rest.remove_prefix(end + 2);
  }
  return html.append(rest);
}

}  // namespace orchard::view

// SPDX-License-Identifier: BSD-3-Clause
#include "io/report/summary_facts.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "io/file_error.hpp"
#include "text/date_text.hpp"
#include "text/printable_text.hpp"

namespace orchard::io {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kWarningsMax = 20;
constexpr std::size_t kWarningLengthMax = 400;
constexpr std::uintmax_t kBytesMax = 64u << 20;

std::string text_in(const Json& json, const char* key) {
  const auto it = json.find(key);
  return it != json.end() && it->is_string() ? printable_text(it->get<std::string>()) : "";
}

std::int64_t number_in(const Json& json, const char* key) {
  const auto it = json.find(key);
  return it != json.end() && it->is_number_integer() ? it->get<std::int64_t>() : 0;
}

void add_stretch(const Json& stretch, std::string_view fix_channel, SummaryFacts& facts) {
  if (!stretch.is_object()) return;
  const double duration_s = 1e-6 * (static_cast<double>(number_in(stretch, "last_utime_us")) -
                                    static_cast<double>(number_in(stretch, "first_utime_us")));
  if (!(duration_s >= 0.0)) return;
  if (text_in(stretch, "missing") == fix_channel) {
    facts.without_fixes_s += duration_s;
    return;
  }
  facts.without_pictures_s += duration_s;
  const std::int64_t first = number_in(stretch, "first_landmark");
  const std::int64_t last = number_in(stretch, "last_landmark");
  if (first > 0 && last >= first && last < INT32_MAX) {
    facts.num_met_without_pictures += static_cast<int>(last - first + 1);
  }
}

}  // namespace

SummaryFacts read_summary_facts(const std::string& folder_or_csv, std::string_view fix_channel) {
  namespace fs = std::filesystem;
  fs::path folder(folder_or_csv);
  if (!fs::is_directory(folder)) folder = folder.parent_path();
  const fs::path path = folder / "summary.json";
  SummaryFacts facts;
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return facts;
  if (fs::file_size(path, error) > kBytesMax) {
    throw FileError(path.string() + ": too large for the summary of a map");
  }
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object())
    throw FileError(path.string() + ": not a JSON object, so not the summary of a map");
  facts.day = date_text(number_in(json, "first_utime_us"));
  facts.version = text_in(json, "version");
  if (const auto it = json.find("degraded"); it != json.end() && it->is_array()) {
    for (const Json& stretch : *it) add_stretch(stretch, fix_channel, facts);
  }
  if (const auto it = json.find("warnings"); it != json.end() && it->is_array()) {
    for (const Json& warning : *it) {
      if (!warning.is_string() || facts.warnings.size() >= kWarningsMax) continue;
      facts.warnings.push_back(
          printable_text(warning.get<std::string>().substr(0, kWarningLengthMax)));
    }
  }
  return facts;
}

}  // namespace orchard::io

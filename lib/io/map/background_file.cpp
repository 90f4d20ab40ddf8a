// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/background_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "view/page.hpp"

namespace orchard::io {
namespace {

constexpr char kPicture[] = "background.jpg", kPlace[] = "background.json";
// derived: four times a picture of background.cpp; a page of 100,000 trees with such a one.
constexpr std::size_t kPictureMax_bytes = std::size_t{16} << 20,
                      kPageMax_bytes = std::size_t{256} << 20;

std::string in(const std::string& folder, const char* name) {
  return (std::filesystem::path(folder) / name).string();
}

}  // namespace

std::optional<view::Background> read_background(const std::string& folder) {
  std::error_code error;
  if (!std::filesystem::exists(in(folder, kPicture), error)) return std::nullopt;
  const std::string advice = "set the background again with `orchard edit background`";
  view::Background background;
  background.jpeg = read_file(in(folder, kPicture), kPictureMax_bytes, advice);
  const std::string at = in(folder, kPlace);
  const auto json = nlohmann::json::parse(read_file(at, 1000, advice), nullptr, false);
  const auto box = json.is_object() ? json.value("box_m", nlohmann::json()) : nlohmann::json();
  const bool is_box =
      box.is_array() && box.size() == 4 &&
      std::all_of(box.begin(), box.end(), [](const auto& v) { return v.is_number(); });
  if (is_box) {
    background.low_map = {box[0].get<double>(), box[1].get<double>()};
    background.high_map = {box[2].get<double>(), box[3].get<double>()};
  }
  if (!is_box || !((background.high_map - background.low_map).minCoeff() > 0.0)) {
    throw FileError(at + " does not place " + kPicture + " in the map; " + advice);
  }
  return background;
}

void write_background(const std::string& folder, const view::Background& b,
                      FileReplacement& files) {
  files.write(in(folder, kPicture), b.jpeg);
  files.write(in(folder, kPlace),
              fmt::format("{{\"box_m\": [{:.3f}, {:.3f}, {:.3f}, {:.3f}]}}\n", b.low_map.x(),
                          b.low_map.y(), b.high_map.x(), b.high_map.y()));
}

void set_background(const std::string& folder, const view::Background& background) {
  const std::string path = in(folder, "map.html");
  const std::string page = view::with_background(
      read_file(path, kPageMax_bytes, "give a map folder"), view::background_json(background));
  if (page.empty()) throw FileError(path + " is not a page of `orchard map`; give a map folder");
  FileReplacement files;
  write_background(folder, background, files);
  files.write(path, page);
  files.commit();
}

}  // namespace orchard::io

// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/recording_folder.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <utility>

#include "io/file_error.hpp"
#include "io/recording/jpeg_file.hpp"
#include "io/recording/recording_sensors.hpp"

namespace orchard::io {
namespace {

namespace fs = std::filesystem;
using Source = std::function<std::optional<SensorMessage>()>;

struct ImageFile {
  std::int64_t utime = 0;
  std::string path;
};

/// Opens the table of that name, plain or compressed; none if neither exists.
std::optional<CsvReader> open_table(const fs::path& folder, const std::string& name) {
  const fs::path plain = folder / (name + ".csv");
  const fs::path compressed = folder / (name + ".csv.gz");
  const bool has_plain = fs::exists(plain), has_compressed = fs::exists(compressed);
  if (has_plain && has_compressed) {
    throw FileError(plain.string() + " exists beside " + compressed.filename().string() +
                    "; remove one of them");
  }
  if (has_plain) return CsvReader::open(plain.string());
  if (has_compressed) return CsvReader::open(compressed.string());
  return std::nullopt;
}

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) {
    throw FileError(
        path.string() +
        ": cannot be read; a recording folder needs this file with the laser's parameters");
  }
  return text.str();
}

std::vector<ImageFile> list_images(const fs::path& folder) {
  std::vector<ImageFile> files;
  if (!fs::is_directory(folder)) return files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string stem = entry.path().stem().string();
    ImageFile file;
    file.path = entry.path().string();
    const auto result = std::from_chars(stem.data(), stem.data() + stem.size(), file.utime);
    if (entry.path().extension() != ".jpg" || result.ec != std::errc() || file.utime < 0 ||
        result.ptr != stem.data() + stem.size()) {
      throw FileError(file.path +
                      ": the name of a picture must be <utime_us>.jpg; rename or remove it");
    }
    files.push_back(std::move(file));
  }
  std::sort(files.begin(), files.end(),
            [](const ImageFile& a, const ImageFile& b) { return a.utime < b.utime; });
  const auto other =
      std::adjacent_find(files.begin(), files.end(),
                         [](const ImageFile& a, const ImageFile& b) { return a.utime == b.utime; });
  if (other != files.end())
    throw FileError(other->path + ": another picture has the same time; remove one");
  return files;
}

template <class Table>
Source table_source(std::shared_ptr<Table> table) {
  return [table]() -> std::optional<SensorMessage> {
    if (auto message = table->next()) return SensorMessage(std::move(*message));
    return std::nullopt;
  };
}

Source image_source(std::vector<ImageFile> files) {
  return [files = std::move(files), i = std::size_t{0}]() mutable -> std::optional<SensorMessage> {
    if (i == files.size()) return std::nullopt;
    vision::Image image = read_jpeg_file(files[i].path);
    image.utime = files[i].utime;
    image.seq = static_cast<std::int32_t>(i++);
    return SensorMessage(std::move(image));
  };
}

}  // namespace

struct RecordingFolder::Impl {
  LaserDescription laser;
  std::vector<Source> sources;  ///< in the order of SensorMessage's alternatives
  std::vector<std::optional<SensorMessage>> heads;
};

RecordingFolder::RecordingFolder(const std::string& path) : impl_(std::make_unique<Impl>()) {
  const fs::path folder(path);
  if (!fs::is_directory(folder)) {
    throw FileError(path + " is not a folder; give a recording folder with sensors.yaml");
  }
  const fs::path sensors = folder / "sensors.yaml";
  impl_->laser = parse_sensors_yaml(read_text(sensors), sensors.string());
  auto scans = open_table(folder, "scans");
  if (!scans) throw FileError(path + " has neither scans.csv nor scans.csv.gz; add one");
  impl_->sources.push_back(table_source(std::make_shared<ScanCsv>(
      std::move(*scans), impl_->laser, open_table(folder, "intensities"))));
  impl_->sources.push_back(image_source(list_images(folder / "images")));
  if (auto csv = open_table(folder, "odometry")) {
    impl_->sources.push_back(table_source(std::make_shared<OdometryCsv>(std::move(*csv))));
  }
  if (auto csv = open_table(folder, "gnss")) {
    impl_->sources.push_back(table_source(std::make_shared<GnssCsv>(std::move(*csv))));
  }
  if (auto csv = open_table(folder, "poses")) {
    impl_->sources.push_back(table_source(std::make_shared<PoseFixCsv>(std::move(*csv))));
  }
  for (Source& source : impl_->sources) impl_->heads.push_back(source());
}

RecordingFolder::~RecordingFolder() = default;

const LaserDescription& RecordingFolder::laser() const { return impl_->laser; }

std::optional<SensorMessage> RecordingFolder::next() {
  std::size_t first = impl_->heads.size();
  for (std::size_t i = 0; i < impl_->heads.size(); ++i) {
    if (!impl_->heads[i]) continue;
    if (first == impl_->heads.size() ||
        utime_of(*impl_->heads[i]) < utime_of(*impl_->heads[first])) {
      first = i;
    }
  }
  if (first == impl_->heads.size()) return std::nullopt;
  std::optional<SensorMessage> message = std::move(impl_->heads[first]);
  impl_->heads[first] = impl_->sources[first]();
  return message;
}

std::vector<SensorMessage> read_recording_folder(const std::string& path) {
  RecordingFolder folder(path);
  std::vector<SensorMessage> messages;
  while (auto message = folder.next()) messages.push_back(std::move(*message));
  return messages;
}

}  // namespace orchard::io

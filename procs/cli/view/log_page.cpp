// SPDX-License-Identifier: BSD-3-Clause
#include "cli/view/log_page.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <stdexcept>

#include "bus/messages/codec.hpp"
#include "bus/messages/decode_as.hpp"
#include "bus/replay/in_process_replay.hpp"
#include "cli/maps/map_pipeline.hpp"
#include "detection/rig.hpp"
#include "io/file_error.hpp"
#include "io/map/map_folder.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "text/number_text.hpp"
#include "view/detections_json.hpp"
#include "view/map_data.hpp"
#include "viewer/live_page.hpp"

namespace orchard::cli {
namespace {

using bus::Channel;
using procs::PageAnswer;

std::string temporary_folder() {
  std::error_code error;
  const auto folder = std::filesystem::temp_directory_path(error);
  return error ? "." : folder.string();
}

std::size_t number_of(const procs::PageContent::Parameters& parameters, const char* key) {
  const auto at = parameters.find(key);
  if (at == parameters.end()) return 0;
  return static_cast<std::size_t>(std::max(0, whole_number(at->second).value_or(0)));
}

struct Stopped : std::runtime_error {
  Stopped() : std::runtime_error("stopped") {}
};

}  // namespace

struct LogPage::Spill {
  Spill() {
    std::string name = temporary_folder() + "/orchard_view_XXXXXX";
    fd = ::mkstemp(name.data());
    if (fd < 0)
      throw io::FileError(temporary_folder() +
                          " cannot be written; set TMPDIR to a folder that can");
    ::unlink(name.c_str());
  }
  ~Spill() { ::close(fd); }
  Spill(const Spill&) = delete;
  Spill& operator=(const Spill&) = delete;

  std::uint64_t append(const std::vector<std::uint8_t>& data) {
    const std::uint64_t offset = end;
    if (::pwrite(fd, data.data(), data.size(), static_cast<off_t>(offset)) !=
        static_cast<ssize_t>(data.size())) {
      throw io::FileError(temporary_folder() + " is full; set TMPDIR to a larger disk");
    }
    end += data.size();
    return offset;
  }
  std::vector<std::uint8_t> read(std::uint64_t offset, std::uint64_t size) const {
    std::vector<std::uint8_t> data(size);
    const ssize_t got = ::pread(fd, data.data(), size, static_cast<off_t>(offset));
    data.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return data;
  }

  int fd = -1;
  std::uint64_t end = 0;
};

LogPage::LogPage(const io::LogPaths& logs, const io::Config& config, const std::string& version)
    : logs_(logs),
      config_(config),
      boot_(std::to_string(std::random_device()())),
      page_(procs::empty_page("drive", logs.names(), version, false, boot_)),
      reader_(std::make_unique<io::LogSeries>(logs)),
      spill_(std::make_unique<Spill>()),
      record_(config.mapper.min_observations) {
  thread_ = std::thread([this] {
    try {
      index();
      map();
      const std::lock_guard<std::mutex> lock(mutex_);
      outcome_ = "ok";
    } catch (const Stopped&) {
    } catch (const std::exception& error) {
      const std::lock_guard<std::mutex> lock(mutex_);
      outcome_ = error.what();
    }
  });
}

LogPage::~LogPage() {
  is_stopping_ = true;
  thread_.join();
}

void LogPage::index() {
  const std::lock_guard<std::mutex> lock(log_mutex_);
  while (const auto event = reader_->next()) {
    if (is_stopping_) throw Stopped();
    const auto channel = bus::find_channel(event->channel);
    if (channel == Channel::kScan) {
      const auto scan = bus::decode_as<laser::Scan>(Channel::kScan, event->data);
      if (scan) scans_.emplace(scan->utime, event->offset);
    } else if (channel == Channel::kImage) {
      const auto image = bus::decode_as<vision::Image>(Channel::kImage, event->data);
      if (image) images_.emplace(image->utime, event->offset);
    }
  }
}

void LogPage::map() {
  MapPipeline pipeline(config_, temporary_folder());
  bus::ReplayOptions replay;
  replay.check = [this] {
    if (is_stopping_) throw Stopped();
  };
  replay.progress = [this, &replay](std::uint64_t done, std::uint64_t total) {
    replay.check();
    const std::lock_guard<std::mutex> lock(mutex_);
    fraction_ = total > 0 ? static_cast<double>(done) / static_cast<double>(total) : 0.0;
  };
  replay.on_derived = [this](Channel channel, std::int64_t utime,
                             const std::vector<std::uint8_t>& data) {
    auto result = bus::decode(channel, data.data(), data.size());
    const auto* message = std::get_if<bus::Message>(&result);
    if (message == nullptr) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    if (const auto* seen = std::get_if<detection::Detections>(message)) {
      record_.take(*seen);
      detections_.emplace(utime, Stored{spill_->append(data), data.size()});
    }
    if (const auto* pose = std::get_if<pose::PoseEstimate>(message)) record_.take(*pose);
    if (const auto* page = std::get_if<pose::TrajectoryPage>(message)) record_.take(*page);
    if (const auto* tile = std::get_if<mapping::MapTile>(message)) record_.take(*tile);
  };
  const bus::ReplayReport report = bus::replay_in_process(logs_, pipeline.nodes(), replay);
  replay.check();
  io::MapSummary summary;
  summary.first_utime = report.first_utime;
  summary.last_utime = report.last_utime;
  const io::MapFolderContent content = pipeline.mapper.content(summary);
  replay.check();
  const std::lock_guard<std::mutex> lock(mutex_);
  record_.finish(content.landmarks);
  finish_json_ = "," + view::rows_and_ways_json(content.rows, content.graph);
  if (content.georeference) {
    finish_json_ += ",\"georeference\":" + view::georeference_json(*content.georeference);
  }
  fraction_ = 1.0;
}

std::string LogPage::outcome() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return outcome_;
}

std::string LogPage::news(const Parameters& parameters) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  view::DriveProgress seen{number_of(parameters, "steps"), number_of(parameters, "changes"),
                           number_of(parameters, "paths")};
  const std::string text = record_.news_json(seen);
  const bool has_failed = !outcome_.empty() && outcome_ != "ok";
  return "{" + text + ",\"seen\":[" + std::to_string(seen.steps) + "," +
         std::to_string(seen.changes) + "," + std::to_string(seen.paths) +
         "],\"share\":" + std::to_string(fraction_) +
         ",\"problem\":" + view::json_text(has_failed ? outcome_ : "") + finish_json_ + "}";
}

/// The message of that time in the log, if any.
template <class Kind>
std::optional<Kind> LogPage::read(const Places& places, Channel channel, std::int64_t utime) const {
  const std::lock_guard<std::mutex> lock(log_mutex_);
  const auto place = places.find(utime);
  if (place == places.end()) return std::nullopt;
  return bus::decode_as<Kind>(channel, reader_->read_at(place->second).data);
}

std::optional<detection::Detections> LogPage::detections_of(std::int64_t utime) const {
  Stored stored;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = detections_.find(utime);
    if (found == detections_.end()) return std::nullopt;
    stored = found->second;
  }
  return bus::decode_as<detection::Detections>(Channel::kDetections,
                                               spill_->read(stored.offset, stored.size));
}

std::optional<std::string> LogPage::step(std::size_t at) const {
  std::int64_t utime = 0;
  std::optional<geometry::Pose2> pose;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (at >= record_.num_steps()) return std::nullopt;
    utime = record_.utime_of(at);
    pose = record_.pose_at(at);
  }
  const detection::Rig rig(config_.laser, config_.camera, config_.detector);
  std::string text = "{\"step\":" + std::to_string(at) + ",\"utime\":" + std::to_string(utime);
  const auto scan = pose ? read<laser::Scan>(scans_, Channel::kScan, utime) : std::nullopt;
  if (scan) text += ",\"points\":" + view::scan_points_json(*scan, *pose, rig);
  const auto detections = detections_of(utime);
  if (detections && detections->image_utime != 0) {
    text +=
        ",\"look\":{" + view::detections_json(*detections, rig, "at=" + std::to_string(at)) + "}";
  }
  return text + "}";
}

std::optional<PageAnswer> LogPage::picture(std::size_t at) const {
  std::int64_t utime = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (at >= record_.num_steps()) return std::nullopt;
    utime = record_.utime_of(at);
  }
  const auto detections = detections_of(utime);
  if (!detections) return std::nullopt;
  const auto image = read<vision::Image>(images_, Channel::kImage, detections->image_utime);
  if (!image) return std::nullopt;
  const view::ShownPicture shown = view::shown_picture(*image);
  return PageAnswer{200, shown.type, shown.bytes};
}

std::optional<PageAnswer> LogPage::get(const std::string& name, const Parameters& parameters) {
  const auto of_page = parameters.find("boot");
  if (of_page != parameters.end() && of_page->second != boot_) {
    return PageAnswer{409, "text/plain", "This page belongs to an earlier viewer. Reload it.\n"};
  }
  try {
    if (name == "drive") return PageAnswer{200, "application/json", news(parameters)};
    if (name == "picture") return picture(number_of(parameters, "at"));
    if (name != "step") return std::nullopt;
    auto text = step(number_of(parameters, "at"));
    if (!text) return std::nullopt;
    return PageAnswer{200, "application/json", std::move(*text)};
  } catch (const io::FileError&) {
    return std::nullopt;  // the log file has changed meanwhile
  }
}

}  // namespace orchard::cli

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "bus/messages/channel.hpp"
#include "detection/detection.hpp"
#include "io/config/config.hpp"
#include "io/log/log_series.hpp"
#include "view/drive_record.hpp"
#include "viewer/page_server.hpp"

namespace orchard::cli {

/// The page of a log: maps the log in the background and lets users step through it scan by scan.
///
/// Scans and pictures stay in the log and are read on request; detections are kept in an unnamed
/// file in the temporary folder.
class LogPage : public procs::PageContent {
 public:
  /// Starts mapping. Throws io::FileError when the log or the temporary folder cannot be opened;
  /// outcome() reports other errors.
  LogPage(const io::LogPaths& logs, const io::Config& config, const std::string& version);
  ~LogPage() override;

  std::string page() const override { return page_; }
  std::vector<std::string> events_for(view::ViewerProgress&, bool& is_more) const override {
    is_more = false;
    return {};
  }
  /// `drive?steps=N&changes=N&paths=N`: everything new since; `step?at=K`: scan K and its trunk
  /// candidates; `picture?at=K`.
  std::optional<procs::PageAnswer> get(const std::string& name,
                                       const Parameters& parameters) override;
  procs::PageAnswer edit(const std::string&) override { return {405, "text/plain", ""}; }

  /// The result of the mapping: empty while it runs, "ok", or the error.
  std::string outcome() const;

 private:
  /// Offset in the log of each message, by utime.
  using Places = std::map<std::int64_t, std::uint64_t>;
  struct Stored {
    std::uint64_t offset = 0, size = 0;
  };
  struct Spill;  ///< the file of detections

  void index();
  void map();
  std::string news(const Parameters& parameters) const;
  template <class Kind>
  std::optional<Kind> read(const Places& places, bus::Channel channel, std::int64_t utime) const;
  std::optional<detection::Detections> detections_of(std::int64_t utime) const;
  std::optional<std::string> step(std::size_t at) const;
  std::optional<procs::PageAnswer> picture(std::size_t at) const;

  io::LogPaths logs_;
  io::Config config_;
  std::string boot_;  ///< identifies this run of the server: the page of an earlier run reloads
  std::string page_;
  mutable std::mutex log_mutex_;  ///< guards the reader and the places in its log
  std::unique_ptr<io::LogSeries> reader_;
  Places scans_, images_;
  std::unique_ptr<Spill> spill_;
  mutable std::mutex mutex_;  ///< guards all below
  view::DriveRecord record_;
  std::map<std::int64_t, Stored> detections_;  ///< by utime
  std::string finish_json_;  ///< rows, navigation graph and georeference, after mapping
  std::string outcome_;
  double fraction_ = 0.0;
  std::atomic<bool> is_stopping_{false};
  std::thread thread_;
};

}  // namespace orchard::cli

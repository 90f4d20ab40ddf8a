// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "io/config/config.hpp"
#include "io/log/log_series.hpp"
#include "view/drive_record.hpp"
#include "viewer/page_content.hpp"

namespace orchard::cli {

/// The page of a log: it is mapped while people look on, and stepped through scan by scan.
///
/// Scans and pictures stay in the log and are read when a page asks for them; detections lie in a
/// file without a name in the folder for temporary ones.
class LogPage : public procs::PageContent {
 public:
  /// Begins to map. Throws io::FileError when the log or the temporary folder cannot be opened;
  /// what else goes wrong, outcome() says.
  LogPage(const io::LogPaths& logs, const io::Config& config, const std::string& version);
  ~LogPage() override;

  std::string page() const override { return page_; }
  std::vector<std::string> events_for(view::Seen&, bool& is_more) const override {
    is_more = false;
    return {};
  }
  /// `drive?steps=N&changes=N&paths=N`: what is new since; `step?at=K`: scan and what the camera
  /// was asked; `picture?at=K`.
  std::optional<procs::PageAnswer> get(const std::string& name,
                                       const Parameters& parameters) override;
  procs::PageAnswer edit(const std::string&) override { return {405, "text/plain", ""}; }

  /// How the mapping went, once it has ended: empty while it runs, "ok", or what went wrong.
  std::string outcome() const;

 private:
  /// Where in the log a message lies, by the time in it.
  using Places = std::vector<std::pair<std::int64_t, std::uint64_t>>;
  struct Stored {
    std::int64_t utime = 0;
    std::uint64_t offset = 0, size = 0;
  };
  struct Spill;  ///< the file of detections

  void index();
  void map();
  std::string news(const Parameters& parameters) const;
  std::optional<std::string> step(std::size_t at) const;
  std::optional<procs::PageAnswer> picture(std::size_t at) const;

  io::LogPaths logs_;
  io::Config config_;
  std::string boot_;  ///< of this server: a page of another one loads itself anew
  std::string page_;
  Places scans_, images_;
  mutable std::mutex log_mutex_;  ///< of the reader
  std::unique_ptr<io::LogSeries> reader_;
  std::unique_ptr<Spill> spill_;
  mutable std::mutex mutex_;  ///< of all below
  view::DriveRecord record_;
  std::vector<Stored> detections_;
  std::string finish_json_;  ///< rows, ways, place on the earth: once it is mapped
  std::string outcome_;
  double fraction_ = 0.0;
  std::atomic<bool> is_stopping_{false};
  std::thread thread_;
};

}  // namespace orchard::cli

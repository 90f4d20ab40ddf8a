// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bus/messages/service_messages.hpp"

namespace orchard::cli {

/// The last known status of a process.
struct ProcessView {
  bus::Status status;
  double age_s = 0.0;             ///< since its last STATUS
  double input_hz = 0.0;          ///< 0 without input
  double clock_offset_s = 0.0;    ///< clock of its host minus ours; 0 on our own
  std::int64_t num_new_lost = 0;  ///< messages lost since the STATUS before
};

/// Collects the status of all processes of all hosts from STATUS. Pure: times are arguments.
class StatusBoard {
 public:
  /// `own_machine`: the name of this machine, whose processes have its clock.
  explicit StatusBoard(std::string own_machine = {}) : own_machine_(std::move(own_machine)) {}

  /// Adds a STATUS. `receipt_utime`: our clock at its arrival [us].
  void note(const bus::Status& status, std::int64_t receipt_utime);

  /// The processes in order of host and name, without those silent for a minute.
  std::vector<ProcessView> processes(std::int64_t now_utime) const;

 private:
  struct Entry {
    bus::Status last;
    std::int64_t receipt_utime = 0;
    std::int64_t num_new_lost = 0;
    std::vector<std::int64_t> offsets_us;  ///< STATUS utime minus receipt time, of the last few
  };
  void forget_earlier(const bus::Status& status, std::int64_t receipt_utime);

  std::string own_machine_;
  std::map<std::pair<std::string, std::string>, Entry> entries_;
};

/// Min silence of a process that one late STATUS cannot explain [s].
constexpr double kSilent_s = 2.5;

/// Max acceptable difference between the clocks of two hosts [s]: at 1 m/s it displaces
/// observations by 2 cm.
constexpr double kClockOffsetMax_s = 0.02;

/// The state of a process in one word: "ok", "waiting", "warning", "error", "silent".
std::string state_word(const ProcessView& process);

/// True if a process needs attention: any state except ok and waiting, or a clock offset.
bool needs_attention(const ProcessView& process);

/// Formats the processes as a table with a header; each has one line, with its text below. Lines
/// are cut at `width` columns (0: not cut). `colour`: with escape codes for a terminal. Control
/// characters in received text are replaced.
std::string status_table(const std::vector<ProcessView>& processes, std::size_t width, bool colour);

/// The lines of one process in the table.
std::string process_lines(const ProcessView& process, std::size_t width, bool colour);

/// The processes as one JSON object with a list.
std::string status_json(const std::vector<ProcessView>& processes);

/// Period of redrawing the screen.
inline constexpr std::chrono::milliseconds kRedraw{500};

/// Prints the status of all processes: a redrawn table on a terminal; in a pipe, a line whenever
/// the state or text of a process changes.
class StatusScreen {
 public:
  /// `headline`: lines above the table.
  void show(const StatusBoard& board, const std::string& headline, std::int64_t now_utime);

  /// True if standard output is a terminal.
  static bool is_terminal();

 private:
  void print_changes(const std::vector<ProcessView>& processes);
  std::map<std::string, std::string> said_;
};

}  // namespace orchard::cli

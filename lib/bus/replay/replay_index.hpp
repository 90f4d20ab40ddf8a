// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include "bus/messages/channel.hpp"
#include "bus/replay/in_process_replay.hpp"

namespace orchard::bus {

/// Position of one source message in a log.
struct ReplayEntry {
  std::int64_t drive_time = 0;
  Channel channel = Channel::kScan;
  std::int32_t seq = 0;
  std::uint64_t offset = 0;  ///< as given by io::LogSeries
};

/// A list of entries that is read in order only. Each entry is stored as its difference to the one
/// before, in about eight bytes: a drive of a day has millions.
class ReplayEntries {
  /// The values that the next entry is stored relative to.
  struct Last {
    std::int64_t drive_time = 0;
    std::uint64_t offset = 0;
    std::array<std::int32_t, kNumChannels> seq{};
  };

 public:
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = ReplayEntry;
    using difference_type = std::ptrdiff_t;
    using pointer = const ReplayEntry*;
    using reference = const ReplayEntry&;

    reference operator*() const { return entry_; }
    pointer operator->() const { return &entry_; }
    Iterator& operator++();
    bool operator==(const Iterator& other) const { return at_ == other.at_; }
    bool operator!=(const Iterator& other) const { return at_ != other.at_; }

   private:
    friend class ReplayEntries;
    Iterator(const std::vector<std::uint8_t>& bytes, std::size_t at) : bytes_(&bytes), at_(at) {}
    void read();

    const std::vector<std::uint8_t>* bytes_;
    std::size_t at_;        ///< of the entry's first byte
    std::size_t next_ = 0;  ///< and of the next one's
    Last last_;
    ReplayEntry entry_;
  };

  void push_back(const ReplayEntry& entry);
  void shrink_to_fit() { bytes_.shrink_to_fit(); }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  Iterator begin() const;
  Iterator end() const { return {bytes_, bytes_.size()}; }

 private:
  std::vector<std::uint8_t> bytes_;
  Last last_;
  std::size_t size_ = 0;
};

/// Measures the delay between measurement and recording for sensors that publish without delay.
/// Differences between channels reveal a clock offset, which STATUS reports in a live system.
class ArrivalDelays {
 public:
  void add(Channel channel, std::int64_t utime, std::int64_t recorded_utime);

  /// Warnings for the user about channels with a different clock. Empty when all agree, when only
  /// one channel has data, or when the log was not recorded in real time.
  std::vector<std::string> warnings() const;

 private:
  /// Keeps every n-th message, so that memory does not grow with the log.
  struct Sample {
    std::int64_t num = 0;
    std::int64_t every = 1;
    std::vector<std::int64_t> delays_us;
  };
  std::array<Sample, kNumChannels> samples_;
};

struct ReplayIndex {
  ReplayEntries entries;  ///< in order of (drive time, channel, seq, offset)
  ReplayReport report;    ///< what was read, refused and missing; num_in and num_out are 0
};

/// Reads a log, or several logs of one drive, once and lists the source messages in replay order.
/// Throws io::FileError as replay_in_process does.
ReplayIndex index_log(const io::LogPaths& logs, const ReplayOptions& options);

}  // namespace orchard::bus

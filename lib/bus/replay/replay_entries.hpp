// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include "bus/messages/channel.hpp"

namespace orchard::bus {

/// Position of one source message in a log.
struct ReplayEntry {
  std::int64_t utime = 0;
  Channel channel = Channel::kScan;
  std::int32_t seq = 0;
  std::uint64_t offset = 0;  ///< as given by io::LogSeries
};

/// A list of entries that is read in order only. Each entry is stored as its difference to the one
/// before, in about eight bytes: a drive of a day has millions.
class ReplayEntries {
  /// The values that the next entry is stored relative to.
  struct Last {
    std::int64_t utime = 0;
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

}  // namespace orchard::bus

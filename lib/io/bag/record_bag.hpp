// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <istream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/bag/bag_reader.hpp"
#include "io/bag/record_format.hpp"
#include "io/log/file_window.hpp"

namespace orchard::io {

/// Reads a bag that is a file of records, some of them chunks of records: rosbag and MCAP.
class RecordBag : public BagReader {
 public:
  /// The stream must be seekable and begin with the format's magic.
  RecordBag(std::unique_ptr<std::istream> stream, std::unique_ptr<RecordFormat> format);

  std::optional<BagMessage> next() override;
  std::optional<BagMessage> at(const BagPlace& place) override;
  const std::vector<BagTopic>& topics() const override { return topics_; }
  const std::vector<std::string>& losses() const override { return losses_; }
  std::uint64_t position() const override { return position_; }
  std::uint64_t size() const override { return window_.size(); }

 private:
  /// An unpacked chunk and the position of its next record.
  struct Chunk {
    std::uint64_t place = 0;
    std::vector<std::uint8_t> content;
    std::uint64_t position = 0;
  };

  std::optional<BagMessage> next_in_chunk();
  std::optional<BagMessage> message_of(const MessageRecord& record, const BagPlace& place);
  void add_topic(const TopicRecord& record);
  std::optional<std::vector<std::uint8_t>> content_of(const ChunkRecord& chunk,
                                                      std::uint64_t place);
  void go_on_behind_damage(const std::string& why);
  void lose(const std::string& what);
  /// Returns the complete record at `place`; none when it ends beyond the file or is too large.
  std::optional<FileWindow::View> record_at(std::uint64_t place);

  FileWindow window_;
  std::unique_ptr<RecordFormat> format_;
  std::uint64_t position_ = 0;
  std::optional<Chunk> chunk_;  ///< current chunk of next()
  std::deque<Chunk> recent_;    ///< chunks unpacked by at()
  std::map<std::uint32_t, std::size_t> topic_of_id_;
  std::vector<BagTopic> topics_;
  std::vector<std::string> losses_;
};

}  // namespace orchard::io

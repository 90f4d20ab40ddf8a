// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "io/bag/bag_reader.hpp"

namespace orchard::io {

/// Reads a bag in rosbag2's sqlite3 storage: tables `topics` and `messages`; single messages may be
/// zstd-compressed. A row that SQLite cannot read ends the reading and is listed in losses().
class SqliteBag : public BagReader {
 public:
  /// Throws FileError when the file is not a database or lacks these tables.
  explicit SqliteBag(const std::string& path);
  ~SqliteBag() override;
  SqliteBag(const SqliteBag&) = delete;
  SqliteBag& operator=(const SqliteBag&) = delete;

  std::optional<BagMessage> next() override;
  std::optional<BagMessage> at(const BagPlace& place) override;
  const std::vector<BagTopic>& topics() const override;
  const std::vector<std::string>& losses() const override;
  std::uint64_t position() const override;
  std::uint64_t size() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace orchard::io

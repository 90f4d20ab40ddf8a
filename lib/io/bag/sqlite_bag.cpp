// SPDX-License-Identifier: BSD-3-Clause
#include "io/bag/sqlite_bag.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <map>
#include <utility>

#include "io/bag/unpack.hpp"
#include "io/file_error.hpp"

namespace orchard::io {
namespace {

constexpr std::size_t kMaxLosses = 100;
constexpr std::size_t kMaxTopics = 10000;

using Database = std::unique_ptr<sqlite3, int (*)(sqlite3*)>;
using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

/// Opens the database read-only and restricted: its content must not execute code or access other
/// files, and no row may exhaust the memory.
Database open(const std::string& path) {
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &raw, SQLITE_OPEN_READONLY, nullptr);
  Database database(raw, sqlite3_close);
  if (code != SQLITE_OK) {
    throw FileError(path + ": cannot be opened as an SQLite database" +
                    (raw ? std::string(" (") + sqlite3_errmsg(raw) + ")" : ""));
  }
  sqlite3_db_config(raw, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(raw, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(raw, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(raw, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_limit(raw, SQLITE_LIMIT_LENGTH, static_cast<int>(BagReader::kMaxMessageBytes) + 1024);
  return database;
}

Statement prepare(sqlite3* database, const std::string& path, const char* sql) {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(database, sql, -1, &raw, nullptr) != SQLITE_OK) {
    throw FileError(path + ": not a bag of rosbag2, or damaged (" + sqlite3_errmsg(database) + ")");
  }
  return Statement(raw, sqlite3_finalize);
}

std::string text(sqlite3_stmt* row, int column) {
  const unsigned char* begin = sqlite3_column_text(row, column);
  const int size = sqlite3_column_bytes(row, column);
  return begin ? std::string(reinterpret_cast<const char*>(begin), static_cast<std::size_t>(size))
               : std::string();
}

}  // namespace

struct SqliteBag::Impl {
  explicit Impl(const std::string& given_path)
      : path(given_path),
        database(open(path)),
        all(prepare(database.get(), path,
                    "SELECT rowid, topic_id, timestamp, data FROM messages ORDER BY rowid")),
        one(prepare(database.get(), path,
                    "SELECT rowid, topic_id, timestamp, data FROM messages WHERE rowid = ?")) {}

  void read_topics() {
    const Statement rows =
        prepare(database.get(), path, "SELECT id, name, type, serialization_format FROM topics");
    int code = SQLITE_DONE;
    while (topics.size() < kMaxTopics && (code = sqlite3_step(rows.get())) == SQLITE_ROW) {
      BagTopic topic;
      topic.name = text(rows.get(), 1);
      topic.type = text(rows.get(), 2);
      topic.wire = ros::Wire::kCdr;
      topic.is_known_wire = text(rows.get(), 3) == "cdr";
      topic_of_id[sqlite3_column_int64(rows.get(), 0)] = topics.size();
      topics.push_back(std::move(topic));
    }
    if (code != SQLITE_DONE && code != SQLITE_ROW) {
      throw FileError(path + ": its topics cannot be read (" + sqlite3_errmsg(database.get()) +
                      ")");
    }
    const Statement count = prepare(database.get(), path, "SELECT max(rowid) FROM messages");
    if (sqlite3_step(count.get()) == SQLITE_ROW) {
      num_rows = static_cast<std::uint64_t>(
          std::max<sqlite3_int64>(0, sqlite3_column_int64(count.get(), 0)));
    }
  }

  void lose(const std::string& what) {
    if (losses.size() < kMaxLosses) losses.push_back(what);
  }

  std::optional<BagMessage> message(sqlite3_stmt* statement) {
    BagMessage message;
    message.place.record = static_cast<std::uint64_t>(sqlite3_column_int64(statement, 0));
    const std::string name = "row " + std::to_string(message.place.record) + " of messages: ";
    const auto topic = topic_of_id.find(sqlite3_column_int64(statement, 1));
    if (topic == topic_of_id.end()) {
      lose(name + "its topic is not defined");
      return std::nullopt;
    }
    message.topic = topic->second;
    message.utime = sqlite3_column_int64(statement, 2) / 1000;
    message.data = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement, 3));
    message.size = static_cast<std::size_t>(sqlite3_column_bytes(statement, 3));
    if (message.data == nullptr) message.size = 0;
    if (!is_zstd(message.data, message.size)) return message;
    unpacked.resize(zstd_size(message.data, message.size, kMaxMessageBytes));
    const std::string mistake = unpacked.empty()
                                    ? std::string("its size is unknown, or above 64 MB")
                                    : unpack("zstd", message.data, message.size, unpacked);
    if (!mistake.empty()) {
      lose(name + mistake);
      return std::nullopt;
    }
    message.data = unpacked.data();
    message.size = unpacked.size();
    return message;
  }

  std::string path;
  Database database;
  Statement all, one;
  std::map<sqlite3_int64, std::size_t> topic_of_id;
  std::vector<BagTopic> topics;
  std::vector<std::string> losses;
  std::vector<std::uint8_t> unpacked;
  std::uint64_t row = 0, num_rows = 0;
  bool is_done = false;
};

SqliteBag::SqliteBag(const std::string& path) : impl_(std::make_unique<Impl>(path)) {
  impl_->read_topics();
}
SqliteBag::~SqliteBag() = default;

std::optional<BagMessage> SqliteBag::next() {
  while (!impl_->is_done) {
    const int code = sqlite3_step(impl_->all.get());
    if (code != SQLITE_ROW) {
      impl_->is_done = true;
      if (code != SQLITE_DONE) {
        impl_->lose("after row " + std::to_string(impl_->row) + " of " +
                    std::to_string(impl_->num_rows) + " no more rows can be read (" +
                    sqlite3_errmsg(impl_->database.get()) + ")");
      }
      break;
    }
    impl_->row = static_cast<std::uint64_t>(sqlite3_column_int64(impl_->all.get(), 0));
    if (auto message = impl_->message(impl_->all.get())) return message;
  }
  return std::nullopt;
}

std::optional<BagMessage> SqliteBag::at(const BagPlace& place) {
  sqlite3_stmt* statement = impl_->one.get();
  sqlite3_reset(statement);
  sqlite3_bind_int64(statement, 1, static_cast<sqlite3_int64>(place.record));
  if (sqlite3_step(statement) != SQLITE_ROW) return std::nullopt;
  return impl_->message(statement);
}

const std::vector<BagTopic>& SqliteBag::topics() const { return impl_->topics; }
const std::vector<std::string>& SqliteBag::losses() const { return impl_->losses; }
std::uint64_t SqliteBag::position() const { return impl_->row; }
std::uint64_t SqliteBag::size() const { return impl_->num_rows; }

}  // namespace orchard::io

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace orchard::io {

/// Reads comma-separated values strictly: a header line, then records with the same number of
/// fields. No quotes, no empty lines, lines of at most kMaxLineBytes. Plain or gzip-compressed.
///
/// Every error is a FileError "file:line:column: what"; columns count characters from 1.
class CsvReader {
 public:
  static constexpr std::size_t kMaxLineBytes = std::size_t{1} << 20;

  /// Opens the file and reads its header. Throws FileError if there is none.
  static CsvReader open(const std::string& path);

  /// Reads text in memory, which must outlive the reader; `name` replaces the path in messages.
  static CsvReader from_text(std::string_view text, const std::string& name);

  CsvReader(CsvReader&&) noexcept;
  CsvReader& operator=(CsvReader&&) noexcept;
  ~CsvReader();

  /// Column names of the header.
  const std::vector<std::string>& columns() const { return columns_; }

  /// Throws FileError unless the header is exactly these columns.
  void expect_columns(const std::vector<std::string>& expected) const;

  /// Reads the next record; false at the end. Throws FileError if its number of fields differs from
  /// the header's.
  bool next();

  std::size_t num_fields() const { return fields_.size(); }
  std::string_view text(std::size_t field) const;

  /// Parses a finite number. Throws FileError.
  double number(std::size_t field) const;
  /// Parses a finite number in [lo, hi]. Throws FileError.
  double number_in(std::size_t field, double lo, double hi) const;
  std::int64_t integer(std::size_t field) const;
  std::int64_t integer_in(std::size_t field, std::int64_t lo, std::int64_t hi) const;

  std::int64_t line() const { return line_; }

  /// Throws FileError "file:line:column: why" for a field of the current record.
  [[noreturn]] void fail(std::size_t field, const std::string& why) const;
  [[noreturn]] void fail_at_column(std::size_t column, const std::string& why) const;

 private:
  class Source;
  class GzipSource;
  class TextSource;

  CsvReader(std::unique_ptr<Source> source, const std::string& name);
  bool read_line();
  void split();

  std::string name_;
  std::unique_ptr<Source> source_;
  std::string buffer_;
  std::size_t buffer_begin_ = 0;
  bool at_end_ = false;
  std::string line_text_;
  std::int64_t line_ = 0;
  std::vector<std::string_view> fields_;
  std::vector<std::string> columns_;
};

}  // namespace orchard::io

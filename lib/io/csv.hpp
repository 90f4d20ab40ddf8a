// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/angles.hpp"
#include "io/gz_file.hpp"
#include "io/sane_limits.hpp"

namespace orchard::io {

/// Reads comma-separated values strictly: a header line, then records with the same number of
/// fields. No empty lines, lines of at most kMaxLineBytes; no quotes, unless the file is one of
/// names (RFC 4180, within a line). Plain or gzip-compressed.
///
/// Every error is a FileError "file:line:column: what"; columns count characters from 1.
class CsvReader {
 public:
  static constexpr std::size_t kMaxLineBytes = std::size_t{1} << 20;

  /// Opens the file and reads its header. Throws FileError if there is none.
  static CsvReader open(const std::string& path);

  /// The same, where fields may be quoted as csv_field() does.
  static CsvReader open_quoted(const std::string& path);

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
  /// Parses a time after `last_utime`. Throws FileError.
  std::int64_t later_utime(std::size_t field, std::int64_t last_utime) const;
  std::int64_t integer_in(std::size_t field, std::int64_t lo, std::int64_t hi) const;

  std::int64_t line() const { return line_; }

  /// Throws FileError "file:line:column: why" for a field of the current record.
  [[noreturn]] void fail(std::size_t field, const std::string& why) const;
  [[noreturn]] void fail_at_column(std::size_t column, const std::string& why) const;

 private:
  CsvReader(std::unique_ptr<GzFile> file, const std::string& name);
  bool read_line();
  void split();
  std::size_t unquote(std::size_t begin);

  std::string name_;
  std::unique_ptr<GzFile> file_;
  std::string buffer_;
  std::size_t buffer_begin_ = 0;
  bool at_end_ = false;
  bool has_quotes_ = false;
  std::string line_text_;
  std::int64_t line_ = 0;
  std::vector<std::string_view> fields_;
  std::vector<std::string> columns_;
};

/// A column of numbers in [lo, hi], one member of T; angles are wrapped into (-pi, pi].
template <class T>
struct CsvColumn {
  const char* name;
  double T::*member;
  double lo, hi;
  bool is_angle = false;
};

/// The columns of a pose in the plane.
template <class T>
std::vector<CsvColumn<T>> pose_columns() {
  return {{"x_m", &T::x_m, -kMaxCoordinate_m, kMaxCoordinate_m},
          {"y_m", &T::y_m, -kMaxCoordinate_m, kMaxCoordinate_m},
          {"yaw_rad", &T::yaw_rad, -kMaxYaw_rad, kMaxYaw_rad, true}};
}

/// Reads a table over time: `utime_us`, then the columns.
template <class T>
class TimedCsv {
 public:
  /// Throws FileError unless the header is these columns.
  TimedCsv(CsvReader csv, std::vector<CsvColumn<T>> columns)
      : csv_(std::move(csv)), columns_(std::move(columns)) {
    std::vector<std::string> names{"utime_us"};
    for (const CsvColumn<T>& column : columns_) names.push_back(column.name);
    csv_.expect_columns(names);
  }

  /// Returns the next line with seq from 0; none at the end. Throws FileError naming file, line and
  /// column, also when time does not increase.
  std::optional<T> next() {
    if (!csv_.next()) return std::nullopt;
    T line;
    line.utime = utime_ = csv_.later_utime(0, utime_);
    line.seq = ++seq_;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const CsvColumn<T>& column = columns_[i];
      const double value = csv_.number_in(i + 1, column.lo, column.hi);
      line.*column.member = column.is_angle ? geometry::wrap_angle_rad(value) : value;
    }
    return line;
  }

 private:
  CsvReader csv_;
  std::vector<CsvColumn<T>> columns_;
  std::int64_t utime_ = -1;
  std::int32_t seq_ = -1;
};

/// Formats a name as a CSV field: quoted if it contains a separator or quotes (RFC 4180).
inline std::string csv_field(const std::string& text) {
  if (text.find_first_of("\",;") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace orchard::io

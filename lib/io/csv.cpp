// SPDX-License-Identifier: BSD-3-Clause
#include "io/csv.hpp"

#include <cmath>
#include <utility>

#include "io/file_error.hpp"
#include "text/number_text.hpp"
#include "text/parse_number.hpp"

namespace orchard::io {
namespace {

std::string shown(std::string_view text) {
  constexpr std::size_t kShownBytes = 40;
  std::string result = "\"";
  for (const char c : text.substr(0, kShownBytes)) result += c >= 0x20 && c < 0x7F ? c : '?';
  return result + (text.size() > kShownBytes ? "...\"" : "\"");
}

}  // namespace

CsvReader CsvReader::open(const std::string& path) {
  return CsvReader(std::make_unique<GzFile>(path, "CSV file"), path);
}

CsvReader CsvReader::open_quoted(const std::string& path) {
  CsvReader reader = open(path);
  reader.has_quotes_ = true;
  return reader;
}

CsvReader::CsvReader(std::unique_ptr<GzFile> file, const std::string& name)
    : name_(name), file_(std::move(file)) {
  if (!read_line())
    throw FileError(name_ + " is empty; the first line of a CSV file must name the columns");
  split();
  for (const std::string_view field : fields_) columns_.emplace_back(field);
}

void CsvReader::expect_columns(const std::vector<std::string>& expected) const {
  if (columns_ == expected) return;
  std::string names;
  for (const std::string& name : expected) names += (names.empty() ? "" : ",") + name;
  std::size_t i = 0;
  while (i < columns_.size() && i < expected.size() && columns_[i] == expected[i]) ++i;
  const std::string found = i < columns_.size() ? shown(columns_[i]) : "nothing";
  throw FileError(name_ + ":1: column " + std::to_string(i + 1) + " is " + found +
                  "; the first line must be " + names);
}

bool CsvReader::next() {
  if (!read_line()) return false;
  split();
  if (fields_.size() == columns_.size()) return true;
  fail_at_column(1, std::to_string(fields_.size()) + " fields, but the first line has " +
                        std::to_string(columns_.size()) + "; the file may be truncated or edited");
}

bool CsvReader::read_line() {
  std::size_t searched = buffer_begin_;
  std::size_t end = std::string::npos;
  while (true) {
    end = buffer_.find('\n', searched);
    if (end != std::string::npos || at_end_) break;
    searched = buffer_.size();
    if (searched - buffer_begin_ > kMaxLineBytes) break;
    if (buffer_begin_ > 0) {
      buffer_.erase(0, buffer_begin_);
      searched -= buffer_begin_;
      buffer_begin_ = 0;
    }
    at_end_ = !file_->read(buffer_);
  }
  ++line_;
  if (end == std::string::npos) {
    if (buffer_begin_ == buffer_.size()) return false;
    end = buffer_.size();
  }
  std::size_t size = end - buffer_begin_;
  if (size > kMaxLineBytes) {
    fail_at_column(kMaxLineBytes, "a line of over 1 MB; give a CSV file");
  }
  if (size > 0 && buffer_[buffer_begin_ + size - 1] == '\r') --size;
  line_text_.assign(buffer_, buffer_begin_, size);
  buffer_begin_ = std::min(end + 1, buffer_.size());
  return true;
}

void CsvReader::split() {
  fields_.clear();
  const std::string_view line = line_text_;
  if (line.empty()) fail_at_column(1, "an empty line; remove it");
  for (std::size_t i = 0; i < line.size(); ++i) {
    const auto c = static_cast<unsigned char>(line[i]);
    if (c == '"' && !has_quotes_) {
      fail_at_column(i + 1, "a quote character; write fields without quotes");
    }
    if (c < 0x20 || c == 0x7F) {
      fail_at_column(i + 1, "a control character; give a CSV file");
    }
  }
  std::size_t begin = 0;
  while (true) {
    std::size_t comma = line.find(',', begin);
    if (begin < line.size() && line[begin] == '"') {
      comma = unquote(begin);
    } else {
      fields_.push_back(line.substr(begin, comma - begin));
      const std::size_t quote = has_quotes_ ? fields_.back().find('"') : std::string_view::npos;
      if (quote != std::string_view::npos) {
        fail_at_column(begin + quote + 1, "a quote within a field; quote the whole and double it");
      }
    }
    if (comma >= line.size()) return;
    begin = comma + 1;
  }
}

/// Adds the field whose quote is at `begin`, its doubled quotes made single in place; returns where
/// it ends.
std::size_t CsvReader::unquote(std::size_t begin) {
  std::size_t to = begin + 1;
  for (std::size_t i = begin + 1; i < line_text_.size(); ++i, ++to) {
    const char next = i + 1 < line_text_.size() ? line_text_[i + 1] : ',';
    if (line_text_[i] == '"' && next == '"') {
      ++i;
    } else if (line_text_[i] == '"') {
      if (next != ',') fail_at_column(i + 2, "text after a closing quote; double quotes in a name");
      fields_.push_back(std::string_view(line_text_).substr(begin + 1, to - begin - 1));
      return i + 1;
    }
    line_text_[to] = line_text_[i];
  }
  fail_at_column(begin + 1, "a quote that is not closed; close it in the same line");
}

std::string_view CsvReader::text(std::size_t field) const { return fields_.at(field); }

double CsvReader::number(std::size_t field) const {
  const std::string_view text = fields_.at(field);
  const auto value = parse_number<double>(text);
  if (!value || !std::isfinite(*value)) fail(field, shown(text) + " is not a finite number");
  return *value;
}

double CsvReader::number_in(std::size_t field, double lo, double hi) const {
  const double value = number(field);
  if (value >= lo && value <= hi) return value;
  fail(field,
       shown(text(field)) + " must be in [" + shortest_text(lo) + ", " + shortest_text(hi) + "]");
}

std::int64_t CsvReader::integer(std::size_t field) const {
  const std::string_view text = fields_.at(field);
  const auto value = parse_number<std::int64_t>(text);
  if (!value) fail(field, shown(text) + " is not a whole number");
  return *value;
}

std::int64_t CsvReader::later_utime(std::size_t field, std::int64_t last_utime) const {
  const std::int64_t utime = integer_in(field, 0, std::int64_t{1} << 60);
  if (utime > last_utime) return utime;
  fail(field, std::to_string(utime) + " is not later than " + std::to_string(last_utime) +
                  " of the line before; sort the lines and remove duplicates");
}

std::int64_t CsvReader::integer_in(std::size_t field, std::int64_t lo, std::int64_t hi) const {
  const std::int64_t value = integer(field);
  if (value >= lo && value <= hi) return value;
  fail(field,
       shown(text(field)) + " must be in [" + std::to_string(lo) + ", " + std::to_string(hi) + "]");
}

void CsvReader::fail(std::size_t field, const std::string& why) const {
  const std::size_t column =
      static_cast<std::size_t>(fields_.at(field).data() - line_text_.data()) + 1;
  const std::string name = field < columns_.size() ? columns_[field] + ": " : "";
  fail_at_column(column, name + why);
}

void CsvReader::fail_at_column(std::size_t column, const std::string& why) const {
  throw FileError(name_ + ":" + std::to_string(line_) + ":" + std::to_string(column) + ": " + why);
}

}  // namespace orchard::io

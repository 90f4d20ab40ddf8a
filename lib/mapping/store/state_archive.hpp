// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace orchard::mapping {

/// Serializes the state of objects to bytes, or restores it from them; for the same program on the
/// same kind of machine. The caller must protect the bytes against corruption.
///
/// One function per class serves both directions: `persist(archive)` passes every member that later
/// outputs depend on: `archive(first_, second_)`.
class StateArchive {
 public:
  /// Creates an archive for writing.
  StateArchive() = default;
  /// Creates an archive for reading; `bytes` must outlive it.
  explicit StateArchive(std::string_view bytes) : left_(bytes), is_reading_(true) {}

  bool is_reading() const { return is_reading_; }
  const std::string& bytes() const { return bytes_; }
  /// Number of bytes not read yet.
  std::size_t num_left() const { return left_.size(); }

  /// Writes or reads the values. Throws std::length_error when the bytes do not fit them.
  template <class... Values>
  void operator()(Values&... values) {
    (visit(values), ...);
  }

  /// Writes or reads `size` bytes of memory. Throws std::length_error when too few bytes are left.
  void raw(void* data, std::size_t size) {
    if (!is_reading_) {
      bytes_.append(static_cast<const char*>(data), size);
      return;
    }
    if (size > left_.size()) throw std::length_error("state: too few bytes");
    if (size > 0) std::memcpy(data, left_.data(), size);
    left_.remove_prefix(size);
  }

 private:
  template <class Value>
  void visit(Value& value) {
    if constexpr (std::is_trivially_copyable_v<Value> && !std::is_pointer_v<Value>) {
      raw(&value, sizeof(value));
    } else {
      value.persist(*this);
    }
  }

  template <int kRows, int kColumns>
  void visit(Eigen::Matrix<double, kRows, kColumns>& matrix) {
    static_assert(kRows > 0 && kColumns > 0);
    raw(matrix.data(), sizeof(double) * kRows * kColumns);
  }

  template <class First, class Second>
  void visit(std::pair<First, Second>& pair) {
    visit(pair.first);
    visit(pair.second);
  }

  template <class Value>
  void visit(std::vector<Value>& values) {
    std::uint64_t count = values.size();
    std::uint32_t size = sizeof(Value);
    (*this)(count, size);
    if (is_reading_ && (size != sizeof(Value) || count > left_.size())) {
      throw std::length_error("state: of another program");
    }
    values.resize(count);
    if constexpr (std::is_trivially_copyable_v<Value>) {
      raw(values.data(), count * sizeof(Value));
    } else {
      for (Value& value : values) visit(value);
    }
  }

  std::string bytes_;
  std::string_view left_;
  bool is_reading_ = false;
};

}  // namespace orchard::mapping

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace orchard::device {

/// The two forms of a SICK telegram (listing 8014631, 2.1 and 2.2).
enum class ColaDialect {
  kA,  ///< text between STX and ETX
  kB,  ///< binary fields after four STX and a length, before a checksum
};

/// "CoLa-A" or "CoLa-B".
std::string_view name_of(ColaDialect dialect);

/// The bytes of a telegram on the wire.
std::string framed(ColaDialect dialect, std::string_view telegram);

/// What stands at the beginning of received bytes.
struct ColaPiece {
  enum class Kind {
    kIncomplete,  ///< the end has not arrived; num_bytes is 0
    kTelegram,
    kBroken,  ///< a telegram that is cut off, or whose checksum is wrong
    kNoise,   ///< bytes outside of any telegram
  };
  Kind kind = Kind::kIncomplete;
  std::size_t num_bytes = 0;  ///< length of the piece
  std::string_view telegram;  ///< of kTelegram, without its frame
};

/// The first piece of `bytes`. Every byte belongs to a piece, and after a broken one the next
/// telegram is found. A length above `max_bytes` is none.
ColaPiece first_piece(ColaDialect dialect, std::string_view bytes, std::size_t max_bytes);

/// Reads the fields of a telegram in sequence, of either dialect: a number is hexadecimal text up
/// to the next blank, or big-endian bytes. After the first missing or malformed field, ok() is
/// false and nothing more is read.
class ColaFields {
 public:
  ColaFields(ColaDialect dialect, std::string_view fields) : dialect_(dialect), rest_(fields) {}

  bool ok() const { return ok_; }

  /// The next word up to a blank, such as "sRA" and "LMDscandata": text in both dialects.
  std::string_view word();

  /// Text of a known length.
  std::string_view text(std::size_t num_characters);

  /// An unsigned number of 1, 2 or 4 bytes, not above `max`.
  std::uint32_t number(int num_bytes, std::uint32_t max = 0xffffffffu);

  /// A signed number of 4 bytes; as text in two's complement, or decimal after + or -.
  std::int32_t signed_number();

  /// An IEEE 754 number of 4 bytes ("3F800000" is 1).
  float real();

  /// Numbers of that many bytes each that are not used.
  void skip(int num_fields, int num_bytes);

 private:
  std::uint32_t hexadecimal();
  std::uint32_t big_endian(std::size_t num_bytes);

  ColaDialect dialect_;
  std::string_view rest_;
  bool ok_ = true;
};

}  // namespace orchard::device

// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/packed_text.hpp"

#include <zlib.h>

#include <algorithm>
#include <limits>

namespace orchard::procs {

bool accepts_gzip(const std::string& accept_encoding) {
  for (std::size_t begin = 0; begin <= accept_encoding.size();) {
    const std::size_t end = std::min(accept_encoding.find(',', begin), accept_encoding.size());
    std::string coding;
    for (std::size_t k = begin; k < end; ++k) {
      if (accept_encoding[k] != ' ' && accept_encoding[k] != '\t') coding += accept_encoding[k];
    }
    begin = end + 1;
    if (coding == "gzip") return true;
    if (coding.rfind("gzip;q=", 0) == 0) return coding.find_first_of("123456789", 7) != coding.npos;
  }
  return false;
}

std::string gzip(const std::string& text) {
  constexpr int kGzip_window = 15 + 16;  // zlib's way to ask for gzip's frame
  z_stream stream{};
  if (text.size() > std::numeric_limits<uInt>::max() / 2 ||
      deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kGzip_window, 8, Z_DEFAULT_STRATEGY) !=
          Z_OK) {
    return {};
  }
  std::string packed(deflateBound(&stream, static_cast<uLong>(text.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const bool is_done = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  packed.resize(is_done ? stream.total_out : 0);
  deflateEnd(&stream);
  return packed;
}

}  // namespace orchard::procs

// SPDX-License-Identifier: BSD-3-Clause
#include "io/bag/unpack.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <cstring>
#include <memory>

namespace orchard::io {
namespace {

const char* const kOtherLength = "its length differs from the stated one";

std::string unpack_lz4(const std::uint8_t* data, std::size_t size, std::vector<std::uint8_t>& out) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)))
    return "lz4 cannot be initialised";
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      raw, LZ4F_freeDecompressionContext);
  std::size_t read = 0, written = 0;
  while (read < size) {
    std::size_t in = size - read, room = out.size() - written;
    const std::size_t hint =
        LZ4F_decompress(raw, out.data() + written, &room, data + read, &in, nullptr);
    if (LZ4F_isError(hint)) return std::string("damaged: ") + LZ4F_getErrorName(hint);
    read += in;
    written += room;
    if (hint == 0) return written == out.size() ? "" : kOtherLength;  // end of the frame
    if (in == 0 && room == 0) return kOtherLength;
  }
  return "truncated";
}

std::string unpack_bz2(const std::uint8_t* data, std::size_t size, std::vector<std::uint8_t>& out) {
  auto length = static_cast<unsigned>(out.size());
  // libbz2 takes a non-const pointer but does not write to it.
  auto* source = const_cast<char*>(reinterpret_cast<const char*>(data));
  const int code = BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(out.data()), &length, source,
                                              static_cast<unsigned>(size), 0, 0);
  if (code == BZ_OUTBUFF_FULL || (code == BZ_OK && length != out.size())) return kOtherLength;
  return code == BZ_OK ? "" : "damaged (bz2 error " + std::to_string(code) + ")";
}

}  // namespace

std::string unpack(const std::string& compression, const std::uint8_t* data, std::size_t size,
                   std::vector<std::uint8_t>& unpacked) {
  if (compression.empty() || compression == "none") {
    if (size != unpacked.size()) return kOtherLength;
    if (size > 0) std::memcpy(unpacked.data(), data, size);
    return "";
  }
  if (compression == "lz4") return unpack_lz4(data, size, unpacked);
  if (compression == "bz2") return unpack_bz2(data, size, unpacked);
  if (compression == "zstd") {
    const std::size_t length = ZSTD_decompress(unpacked.data(), unpacked.size(), data, size);
    if (ZSTD_isError(length)) return std::string("damaged: ") + ZSTD_getErrorName(length);
    return length == unpacked.size() ? "" : kOtherLength;
  }
  return "compression " + compression.substr(0, 32) +
         ", which is not supported (bz2, lz4 and zstd are)";
}

bool is_zstd(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint8_t kMagic[] = {0x28, 0xB5, 0x2F, 0xFD};
  return size >= sizeof(kMagic) && std::memcmp(data, kMagic, sizeof(kMagic)) == 0;
}

std::size_t zstd_size(const std::uint8_t* data, std::size_t size, std::size_t most_bytes) {
  const unsigned long long length = ZSTD_getFrameContentSize(data, size);
  if (length == ZSTD_CONTENTSIZE_ERROR || length == ZSTD_CONTENTSIZE_UNKNOWN) return 0;
  return length <= most_bytes ? static_cast<std::size_t>(length) : 0;
}

}  // namespace orchard::io

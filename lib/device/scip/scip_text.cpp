// SPDX-License-Identifier: BSD-3-Clause
#include "device/scip/scip_text.hpp"

namespace orchard::device {

char scip_sum(std::string_view text) {
  unsigned sum = 0;
  for (const char c : text) sum += static_cast<unsigned char>(c);
  return static_cast<char>((sum & 0x3fu) + 0x30u);
}

std::optional<std::string_view> checked_line(std::string_view line) {
  if (line.size() < 2) return std::nullopt;
  const std::string_view text = line.substr(0, line.size() - 1);
  if (scip_sum(text) != line.back()) return std::nullopt;
  return text;
}

std::optional<std::string_view> checked_parameter(std::string_view line) {
  if (line.size() < 3 || line[line.size() - 2] != ';') return std::nullopt;
  const std::string_view text = line.substr(0, line.size() - 2);
  if (scip_sum(text) != line.back()) return std::nullopt;
  return text;
}

std::optional<std::uint32_t> scip_number(std::string_view characters) {
  if (characters.empty() || characters.size() > 5) return std::nullopt;
  std::uint32_t number = 0;
  for (const char c : characters) {
    const unsigned bits = static_cast<unsigned char>(c) - 0x30u;
    if (bits > 0x3fu) return std::nullopt;
    number = number << 6 | bits;
  }
  return number;
}

std::optional<ScipReply> parse_scip_reply(std::string_view text) {
  ScipReply reply;
  std::size_t num_lines = 0;
  for (std::size_t begin = 0; begin <= text.size(); ++num_lines) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    if (num_lines == 0) {
      reply.echo = line;
    } else if (num_lines == 1) {
      const auto status = checked_line(line);
      if (!status || status->size() != 2) return std::nullopt;
      reply.status = *status;
    } else {
      reply.body.push_back(line);
    }
    begin = end + 1;
  }
  if (reply.echo.size() < 2 || num_lines < 2) return std::nullopt;
  return reply;
}

}  // namespace orchard::device

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::procs {

/// Whether an Accept-Encoding header of HTTP (RFC 9110, 12.5.3) allows gzip by name.
bool accepts_gzip(const std::string& accept_encoding);

/// Packs a text as gzip (RFC 1952), fast rather than small; empty if there is no memory for it.
std::string gzip(const std::string& text);

}  // namespace orchard::procs

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace orchard::io {

/// Reads a file from outside with a library that is not trusted with it: in a child process that
/// can open no connection and start no program, whose memory and processor time are limited by the
/// size of the file. Returns what `read` returns there. `file_bytes`: of the file and those that
/// belong to it. Throws FileError with the message of an exception in `read`, and naming `path`
/// when the child exceeds a limit or crashes.
std::string read_confined(const std::string& path, std::uint64_t file_bytes,
                          const std::function<std::string()>& read);

}  // namespace orchard::io

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace orchard::io {

/// Thrown when a file cannot be read or written. The message names the file, the place in it, the
/// reason and the remedy. A program that catches it exits with code 3.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Thrown when the system is the reason, not the content of a file: the disk is full or fails,
/// a file may not be written. Another attempt may succeed. A program that catches it exits with
/// code 1.
class SystemError : public FileError {
 public:
  using FileError::FileError;
};

}  // namespace orchard::io

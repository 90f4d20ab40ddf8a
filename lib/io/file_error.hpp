// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace orchard::io {

/// A file that cannot be read or written as what it should be; the message says which, where in
/// it, why, and what to do. A program that gets one exits with code 3.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace orchard::io

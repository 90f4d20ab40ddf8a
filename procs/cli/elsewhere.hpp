// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::cli {

/// Goes on as `program` beside this one, with the same words; returns only by an exception. Throws
/// io::FileError when it cannot be started.
[[noreturn]] void go_on_as(const char* program);

}  // namespace orchard::cli

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::cli {

/// Replaces this process by `program` from the same folder, with the same arguments; does not
/// return. Throws io::FileError when it cannot be started.
[[noreturn]] void replace_by_program(const char* program);

}  // namespace orchard::cli

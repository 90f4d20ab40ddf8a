// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace orchard::io {

/// Replaces `path` by `content` so that a reader sees the old file or the new one, never a half:
/// writes a temporary beside it, syncs, renames. Throws FileError (full disk, no permission) and
/// then leaves the old file as it was.
void write_file_atomically(const std::string& path, std::string_view content);

/// The same for libraries that write by name: `write` fills the temporary path it is given (same
/// extension as `path`); throwing from it leaves the old file as it was.
void replace_file_atomically(const std::string& path,
                             const std::function<void(const std::string& temporary)>& write);

}  // namespace orchard::io

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

/// `orchard import-edits MAP EDITED.gpkg`.
struct ImportEditsOptions {
  std::string map_folder;
  std::string edited_path;
  std::string who;
  bool keep_missing = false;  ///< landmarks missing in the file were not deleted
  bool dry_run = false;
  bool json = false;
};

/// Adds the changes made in a map's GeoPackage to the map's corrections. Returns the exit code: 3
/// when some are in conflict; the others are added all the same. Throws io::FileError.
int run_import_edits(const ImportEditsOptions& options);

}  // namespace orchard::cli

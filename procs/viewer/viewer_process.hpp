// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "bus/node/node.hpp"
#include "io/config/config.hpp"
#include "viewer/live_page.hpp"
#include "viewer/page_server.hpp"

namespace orchard::procs {

/// Command-line options of orchard-viewer.
struct ViewerOptions {
  std::string listen;      ///< "ADDRESS", "ADDRESS:PORT", ":PORT"; empty: 127.0.0.1:8420 or next
  std::string token_file;  ///< file with the token in its first line
  std::string folder;      ///< folder whose free disk space is shown
  std::string
      edit_folder;  ///< folder of the map that users may correct on the page; empty: read-only
};

/// A viewer process: the node, the page server and the row survey.
class ViewerProcess {
 public:
  /// Starts the server and makes the node. Throws std::runtime_error, io::FileError.
  std::unique_ptr<bus::Node> make_node(const io::Config& config, const ViewerOptions& options);

 private:
  std::unique_ptr<SharedLiveState> box_;
  std::unique_ptr<MapEditor> editor_;
  std::unique_ptr<LivePage> page_;
  std::unique_ptr<RowSurvey> survey_;
  std::unique_ptr<PageServer> server_;
};

/// Parses the address and port of --listen. Throws io::FileError for an invalid one.
PageServerOptions parse_listen(const std::string& listen);

/// Reads the token from a file's first line. Throws io::FileError for a token that is too weak.
std::string read_token(const std::string& path);

}  // namespace orchard::procs

// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_process.hpp"

#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <charconv>
#include <cstdio>
#include <fstream>

#include "bus/node/process_options.hpp"
#include "io/file_error.hpp"
#include "viewer/viewer_node.hpp"

namespace orchard::procs {
namespace {

/// Low priority: the processes that measure come first.
constexpr int kNice = 10;
constexpr std::size_t kTokenMin = 12;

}  // namespace

std::string read_token(const std::string& path) {
  std::ifstream file(path);
  std::string token;
  std::getline(file, token);
  const bool is_plain =
      token.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_") ==
      std::string::npos;
  if (!file || token.size() < kTokenMin || !is_plain) {
    throw io::FileError(path + ": its first line must be a token of at least " +
                        std::to_string(kTokenMin) +
                        " letters, digits, - or _; create one with: openssl rand -hex 16");
  }
  return token;
}

PageServerOptions parse_listen(const std::string& listen) {
  PageServerOptions options;
  if (listen.empty()) return options;
  const std::size_t colon = listen.rfind(':');
  const bool has_port = colon != std::string::npos &&
                        (listen.find(':') == colon || (colon > 0 && listen[colon - 1] == ']'));
  std::string address = has_port ? listen.substr(0, colon) : listen;
  if (address.size() > 2 && address.front() == '[' && address.back() == ']') {
    address = address.substr(1, address.size() - 2);
  }
  if (!address.empty()) options.address = address;
  if (!has_port) return options;
  const char* begin = listen.data() + colon + 1;
  const char* end = listen.data() + listen.size();
  const auto result = std::from_chars(begin, end, options.port);
  if (result.ec != std::errc() || result.ptr != end || options.port < 1 || options.port > 65535) {
    throw io::FileError("--listen " + listen + ": must be ADDRESS:PORT with a port of 1 to 65535");
  }
  options.may_move = false;
  return options;
}

std::unique_ptr<bus::Node> ViewerProcess::make_node(const io::Config& config,
                                                    const ViewerOptions& options) {
  setpriority(PRIO_PROCESS, 0, kNice);
  PageServerOptions server = parse_listen(options.listen);
  if (!options.token_file.empty()) server.token = read_token(options.token_file);
  if (!options.edit_folder.empty()) editor_ = std::make_unique<MapEditor>(options.edit_folder);
  const detection::Rig rig(config.laser, config.camera, config.detector);
  box_ = std::make_unique<SharedLiveState>(view::LiveState(rig, config.mapper.min_observations));
  page_ = std::make_unique<LivePage>(*box_, editor_.get(), std::string(bus::version()));
  server_ = std::make_unique<PageServer>(*page_, server);
  if (config.mapper.rows.enabled || editor_) {
    survey_ = std::make_unique<RowSurvey>(*box_, config.mapper.rows, editor_.get());
  }
  spdlog::info("the page is at {}{}", server_->url(), server.token.empty() ? "" : "?token=...");
  return std::make_unique<ViewerNode>(*box_, config.camera.enabled, options.folder);
}

}  // namespace orchard::procs

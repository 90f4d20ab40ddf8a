// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_process.hpp"

#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "bus/messages/service_messages.hpp"
#include "bus/network.hpp"
#include "bus/node/node.hpp"
#include "bus/node/process_options.hpp"
#include "bus/node/process_report.hpp"
#include "cli/field/status_board.hpp"
#include "io/file_error.hpp"
#include "text/number_text.hpp"
#include "viewer/live_page.hpp"

namespace orchard::procs {
namespace {

/// Receives all channels of a drive for the page; sends nothing.
class ViewerNode : public bus::Node {
 public:
  /// `folder`: its disk's free space is shown; empty: none. `box` must outlive this.
  ViewerNode(SharedLiveState& box, bool has_camera, std::string folder)
      : box_(box), has_camera_(has_camera), folder_(std::move(folder)) {}

  std::vector<bus::Channel> inputs() const override {
    using bus::Channel;
    std::vector<Channel> inputs{Channel::kScan,       Channel::kDetections, Channel::kPose,
                                Channel::kTrajectory, Channel::kMap,        Channel::kMapWays};
    if (has_camera_) inputs.push_back(Channel::kImage);
    return inputs;
  }

  std::string_view name() const override { return "viewer"; }
  /// The viewer needs no input: the nodes that need one report it missing in STATUS.
  bus::InputNeed need_of(bus::Channel) const override { return bus::InputNeed::kOccasional; }
  void handle(const bus::Message& input, const bus::Outbox&) override {
    if (const auto* scan = std::get_if<laser::Scan>(&input)) box_.take(*scan);
    if (const auto* image = std::get_if<vision::Image>(&input)) box_.take(*image);
    if (const auto* seen = std::get_if<detection::Detections>(&input)) box_.take(*seen);
    if (const auto* pose = std::get_if<pose::PoseEstimate>(&input)) box_.take(*pose);
    if (const auto* page = std::get_if<pose::TrajectoryPage>(&input)) box_.take(*page);
    if (const auto* tile = std::get_if<mapping::MapTile>(&input)) box_.take(*tile);
    if (const auto* ways = std::get_if<mapping::MapWays>(&input)) box_.take(*ways);
  }
  void handle_status(const bus::Status& status) override {
    const std::int64_t now_utime = bus::wall_utime();
    board_.note(status, now_utime);
    std::string event = cli::status_json(board_.processes(now_utime));
    // The page needs more than `orchard status --json` has: extend the object.
    event.erase(event.rfind('}'));
    std::string more = ",\"kind\":\"status\"";
    std::error_code error;
    const auto disk = std::filesystem::space(folder_, error);
    if (!folder_.empty() && !error) more += ",\"disk_bytes\":" + std::to_string(disk.available);
    for (char& c : event) c = c == '\n' ? ' ' : c;  // an event is one line
    box_.take_status(event + more + "}");
  }
  void flush(const bus::Outbox&) override {}

 private:
  SharedLiveState& box_;
  bool has_camera_;
  std::string folder_;
  cli::StatusBoard board_{bus::machine_name()};
};

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
  options.port = whole_number(listen.substr(colon + 1)).value_or(0);
  if (options.port < 1 || options.port > 65535) {
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
  const std::string robot = bus::parse_network(config.lcm.url).robot;
  page_ = std::make_unique<LivePage>(*box_, editor_.get(), robot.empty() ? "Live" : robot,
                                     std::string(bus::version()));
  server_ = std::make_unique<PageServer>(*page_, server);
  if (config.mapper.rows.has_rows() || editor_) {
    survey_ = std::make_unique<RowSurvey>(*box_, config.mapper.rows, editor_.get());
  }
  spdlog::info("the page is at {}{}", server_->url(), server.token.empty() ? "" : "?token=...");
  return std::make_unique<ViewerNode>(*box_, config.camera.enabled, options.folder);
}

}  // namespace orchard::procs

// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_node.hpp"

#include <filesystem>
#include <utility>
#include <variant>

#include "bus/messages/service_messages.hpp"
#include "bus/node/process_report.hpp"
#include "cli/field/status_text.hpp"

namespace orchard::procs {

ViewerNode::ViewerNode(SharedLiveState& box, bool has_camera, std::string folder)
    : box_(box), has_camera_(has_camera), folder_(std::move(folder)) {}

std::vector<bus::Channel> ViewerNode::inputs() const {
  using bus::Channel;
  std::vector<Channel> inputs{Channel::kScan,       Channel::kDetections, Channel::kPose,
                              Channel::kTrajectory, Channel::kMap,        Channel::kMapWays};
  if (has_camera_) inputs.push_back(Channel::kImage);
  return inputs;
}

void ViewerNode::handle(const bus::Message& input, const bus::Outbox&) {
  if (const auto* scan = std::get_if<laser::Scan>(&input)) box_.take(*scan);
  if (const auto* image = std::get_if<vision::Image>(&input)) box_.take(*image);
  if (const auto* seen = std::get_if<detection::Detections>(&input)) box_.take(*seen);
  if (const auto* pose = std::get_if<pose::PoseEstimate>(&input)) box_.take(*pose);
  if (const auto* page = std::get_if<pose::TrajectoryPage>(&input)) box_.take(*page);
  if (const auto* tile = std::get_if<mapping::MapTile>(&input)) box_.take(*tile);
  if (const auto* ways = std::get_if<mapping::MapWays>(&input)) box_.take(*ways);
}

void ViewerNode::handle_status(const bus::Status& status) {
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

}  // namespace orchard::procs

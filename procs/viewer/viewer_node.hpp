// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

#include "bus/node/node.hpp"
#include "cli/field/status_board.hpp"
#include "viewer/shared_live_state.hpp"

namespace orchard::procs {

/// Receives all channels of a drive for the page; sends nothing.
class ViewerNode : public bus::Node {
 public:
  /// `folder`: its disk's free space is shown; empty: none. `box` must outlive this.
  ViewerNode(SharedLiveState& box, bool has_camera, std::string folder);

  std::string_view name() const override { return "viewer"; }
  std::vector<bus::Channel> inputs() const override;
  /// The viewer needs no input: the nodes that need one report it missing in STATUS.
  bus::InputNeed need_of(bus::Channel) const override { return bus::InputNeed::kOccasional; }
  void handle(const bus::Message& input, const bus::Outbox& send) override;
  void handle_status(const bus::Status& status) override;
  void flush(const bus::Outbox&) override {}

 private:
  SharedLiveState& box_;
  bool has_camera_;
  std::string folder_;
  cli::StatusBoard board_;
};

}  // namespace orchard::procs

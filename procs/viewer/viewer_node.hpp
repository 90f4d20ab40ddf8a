// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

#include "bus/node/node.hpp"
#include "cli/field/status_board.hpp"
#include "viewer/live_box.hpp"

namespace orchard::procs {

/// Listens to a drive for those who look on; sends nothing.
class ViewerNode : public bus::Node {
 public:
  /// `folder`: whose disk is watched; empty: none. `box` outlives this.
  ViewerNode(LiveBox& box, bool has_camera, std::string folder);

  std::string_view name() const override { return "viewer"; }
  std::vector<bus::Channel> inputs() const override;
  /// What does not come is not shown, and STATUS of who needs it says so.
  bus::InputNeed need_of(bus::Channel) const override { return bus::InputNeed::kOccasional; }
  void handle(const bus::Message& input, const bus::Outbox& send) override;
  void overhear(const bus::Status& status) override;
  void flush(const bus::Outbox&) override {}

 private:
  LiveBox& box_;
  bool has_camera_;
  std::string folder_;
  cli::StatusBoard board_;
};

}  // namespace orchard::procs

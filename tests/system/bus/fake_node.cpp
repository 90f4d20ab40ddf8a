// SPDX-License-Identifier: BSD-3-Clause
// A process with a fake node: --role detector|pose|mapper, --mute-after N to fall silent,
// --full-disk to be unable to save, --saved FILE to write one at each save; with FAKE_NODE_ALONE
// in the environment a second one refuses to run.
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "bus/process/process.hpp"
#include "io/config/config.hpp"
#include "node/bus/fake_nodes.hpp"

namespace {

using orchard::bus::Node;

/// A node that hangs after some inputs, as one with a bug would.
class Mute : public Node {
 public:
  Mute(std::unique_ptr<Node> node, int num_inputs)
      : node_(std::move(node)), num_inputs_(num_inputs) {}
  std::string_view name() const override { return node_->name(); }
  std::vector<orchard::bus::Channel> inputs() const override { return node_->inputs(); }
  void handle(const orchard::bus::Message& input, const orchard::bus::Outbox& send) override {
    while (num_inputs_ == 0) pause();
    --num_inputs_;
    node_->handle(input, send);
  }
  void flush(const orchard::bus::Outbox& send) override { node_->flush(send); }

 private:
  std::unique_ptr<Node> node_;
  int num_inputs_;
};

}  // namespace

int main(int argc, char** argv) {
  std::string role = "detector";
  std::string mute_after = "-1";
  orchard::bus::ProcessInfo info;
  info.name = "orchard-fake";
  info.description = "A fake node for tests.";
  info.alone = std::getenv("FAKE_NODE_ALONE") != nullptr;
  std::string full_disk;
  std::string saved;
  info.options = {{"--role", "NAME", "which", &role},
                  {"--mute-after", "N", "inputs", &mute_after},
                  {"--full-disk", "", "every save fails", &full_disk},
                  {"--saved", "FILE", "what a save writes", &saved}};
  const auto make_node = [&] {
    return std::make_unique<Mute>(orchard::bus::testing::make_fake_node(role),
                                  std::atoi(mute_after.c_str()));
  };
  const auto save = [&](Node&, const orchard::bus::SaveRequest& request) -> orchard::bus::Writing {
    if (!saved.empty() && request.kind == orchard::bus::SaveKind::kFinal) {
      std::ofstream(saved) << "saved\n";
    }
    if (full_disk.empty()) return {};
    return [] { throw std::runtime_error("map.csv: no space left on device"); };
  };
  orchard::io::RigFile rig;
  return orchard::bus::run_node_process(argc, argv, info, rig, make_node, save);
}

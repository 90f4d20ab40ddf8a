// SPDX-License-Identifier: BSD-3-Clause
#include "system/tube_scene/tube_scene_run.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>
#include <variant>

#include "bus/messages/message.hpp"
#include "detector/detector_node.hpp"
#include "mapper/mapper_node.hpp"
#include "pose/pose_node.hpp"
#include "simulation/simulator.hpp"
#include "system/tube_scene/wiring.hpp"

namespace orchard::test {
namespace {

constexpr double kGate_m = 0.2;

class Complaints {
 public:
  template <class... Values>
  void unless(bool holds, const char* format, Values... values) {
    if (holds) return;
    char text[200];
    std::snprintf(text, sizeof text, format, values...);
    list_.emplace_back(text);
  }
  std::vector<std::string> take() { return std::move(list_); }

 private:
  std::vector<std::string> list_;
};

}  // namespace

evaluation::MapEvaluation run_tube_scene(std::uint64_t seed, const io::Config& config) {
  simulation::Simulator simulator(simulation::SceneKind::kTubes, seed,
                                  {config.laser, config.camera, config.simulation, {}});
  procs::DetectorNode detector(config);
  procs::PoseNode pose(config);
  procs::MapperNode mapper(config);
  Wiring wiring({&detector, &pose, &mapper});
  while (auto message = simulator.next()) {
    std::visit([&wiring](auto& m) { wiring.put(std::move(m)); }, *message);
  }
  wiring.flush();
  return evaluation::evaluate_map(mapper.content({}).landmarks, simulator.truth(), kGate_m);
}

std::vector<std::string> shortcomings(const evaluation::MapEvaluation& evaluation) {
  Complaints complain;
  for (const auto& object : evaluation.objects) {
    const char* name = object.truth.name.c_str();
    complain.unless(object.landmark.has_value(), "%s is missing", name);
    if (!object.landmark) continue;
    const mapping::Landmark& l = *object.landmark;
    complain.unless(object.right_class(), "%s has the wrong class (roc %.3f, n %d)", name,
                    l.roc_mean, l.num_observations);
    if (object.truth.label == detection::Label::kTree) {
      complain.unless(l.roc_mean >= 0.62 && l.roc_mean <= 0.98, "%s: mean roc %.3f", name,
                      l.roc_mean);
    } else if (object.truth.name == "B2") {
      complain.unless(l.roc_mean < 0.6, "B2: mean roc %.3f", l.roc_mean);
    } else {
      complain.unless(l.roc_mean < 0.01, "%s: mean roc %.3f", name, l.roc_mean);
    }
    complain.unless(std::max(l.se_x_m, l.se_y_m) <= 0.015, "%s: SE %.1f, %.1f mm", name,
                    1e3 * l.se_x_m, 1e3 * l.se_y_m);
  }
  for (const mapping::Landmark& l : evaluation.extra) {
    complain.unless(false, "extra landmark at %.2f, %.2f (class %d, n %d)", l.x_m, l.y_m,
                    static_cast<int>(l.label), l.num_observations);
  }
  complain.unless(evaluation.roc_mean_trees >= 0.78 && evaluation.roc_mean_trees <= 0.95,
                  "mean roc over the trees %.3f", evaluation.roc_mean_trees);
  complain.unless(evaluation.se_x_mean_m <= 0.007, "mean SE in x %.2f mm",
                  1e3 * evaluation.se_x_mean_m);
  complain.unless(evaluation.se_y_mean_m <= 0.007, "mean SE in y %.2f mm",
                  1e3 * evaluation.se_y_mean_m);
  complain.unless(evaluation.all.rmse <= 0.015, "error against truth %.1f mm RMS",
                  1e3 * evaluation.all.rmse);
  return complain.take();
}

}  // namespace orchard::test

// SPDX-License-Identifier: BSD-3-Clause
// adaptation_figures CONFIG FIRST_SEED LAST_SEED [BLUE RED GREEN]: what adaptation is worth while
// the light changes, and what trunk-width posts do to it. Simulates orchards, lets the pictures'
// channels drift evenly over each run (to exp(GREEN) of green and exp(BLUE), exp(RED) of blue and
// red over green at its end) and prints F1 per observation: without drift, with drift and fixed
// models, with drift and adaptation. Then the same orchards with 30 % posts of trunk width.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include "bus/messages/message.hpp"
#include "detector/detector_node.hpp"
#include "io/config/config.hpp"
#include "simulation/simulator.hpp"
#include "vision/decode.hpp"

namespace {

using namespace orchard;
using detection::Label;

constexpr double kRangeMax_m = 4.0;  // of the figures
constexpr double kHiddenMax = 0.1;   // more hidden trees are not counted
constexpr int kMinBeams = 4;         // nor are thinner ones
constexpr double kMatch_m = 0.3;

struct Count {
  int right = 0, wrong = 0, missed = 0;
  void operator+=(const Count& other) {
    right += other.right;
    wrong += other.wrong;
    missed += other.missed;
  }
  double precision() const { return right / std::max(1.0, 1.0 * right + wrong); }
  double recall() const { return right / std::max(1.0, 1.0 * right + missed); }
  double f1() const { return 2.0 * right / std::max(1.0, 2.0 * right + wrong + missed); }
};

struct Run {
  Count count;
  double width_away_m = 0.0;  ///< largest distance of the mean width from the calibrated one
  double colour_away = 0.0;   ///< of either colour, log
  double brightness_away = 0.0;
  std::array<int, 6> actions{};
  detection::AdaptedModel last;
};

using Truth = std::map<std::int64_t, std::vector<simulation::TrueObservation>>;

/// A picture in other light, as plain pixels.
vision::Image in_light(const vision::Image& image, const detection::Light& light) {
  auto pixels = vision::decode(image, {0, 0, image.width_px, image.height_px});
  if (!pixels) throw std::runtime_error("a simulated picture does not decode");
  const double green = std::exp(light.green);
  vision::apply({green * std::exp(light.blue), green, green * std::exp(light.red)}, *pixels);
  vision::Image changed = image;
  changed.encoding = vision::Encoding::kBgr8;
  changed.data = std::move(pixels->bgr);
  return changed;
}

double distance_m(const detection::Detection& d, const simulation::TrueObservation& t) {
  const double a_m = d.range_m + 0.5 * d.width_m, b_m = t.range_m + 0.5 * t.width_m;
  const double angle_rad = d.bearing_rad - t.bearing_rad;
  return std::sqrt(std::max(0.0, a_m * a_m + b_m * b_m - 2 * a_m * b_m * std::cos(angle_rad)));
}

/// Trees of a scan that should be found, found; and trees where none stands.
Count judge(const detection::Detections& found, const Truth& truth) {
  Count count;
  const auto at = truth.find(found.utime);
  if (at == truth.end() || found.image_utime == 0) return count;
  const auto is_taken_for_tree = [&](const simulation::TrueObservation& t) {
    return std::any_of(found.trunks.begin(), found.trunks.end(), [&](const auto& d) {
      return d.label == Label::kTree && distance_m(d, t) < kMatch_m;
    });
  };
  for (const auto& t : at->second) {
    if (t.label != Label::kTree || t.range_m > kRangeMax_m || !t.in_picture) continue;
    if (t.hidden_fraction > kHiddenMax || t.num_beams < kMinBeams) continue;
    ++(is_taken_for_tree(t) ? count.right : count.missed);
  }
  for (const auto& d : found.trunks) {
    if (d.label != Label::kTree || d.range_m > kRangeMax_m) continue;
    const bool is_tree = std::any_of(at->second.begin(), at->second.end(), [&](const auto& t) {
      return t.label == Label::kTree && distance_m(d, t) < kMatch_m;
    });
    if (!is_tree) ++count.wrong;
  }
  return count;
}

/// One detector that gets every message, and what became of it.
class Subject {
 public:
  Subject(const io::Config& config, bool adapts)
      : mean_m_(config.detector.width.mean_m), node_(with(config, adapts)) {}
  void handle(const bus::Message& message, const Truth& truth) {
    node_.handle(message, outbox(truth));
  }
  void flush(const Truth& truth) { node_.flush(outbox(truth)); }
  const Run& run() const { return run_; }

 private:
  static io::Config with(io::Config config, bool adapts) {
    config.detector.adaptation.enabled = adapts;
    return config;
  }
  bus::Outbox outbox(const Truth& truth) {
    return [this, &truth](bus::Message message) {
      if (const auto* found = std::get_if<detection::Detections>(&message)) {
        run_.count += judge(*found, truth);
      } else if (const auto* step = std::get_if<detection::AdaptationStep>(&message)) {
        note(*step);
      }
    };
  }
  void note(const detection::AdaptationStep& step) {
    const detection::Light& light = step.model.light;
    ++run_.actions[static_cast<std::size_t>(step.action)];
    run_.width_away_m = std::max(run_.width_away_m, std::abs(step.model.width_mean_m - mean_m_));
    run_.colour_away = std::max({run_.colour_away, std::abs(light.blue), std::abs(light.red)});
    run_.brightness_away = std::max(run_.brightness_away, std::abs(light.green));
    run_.last = step.model;
  }
  double mean_m_;
  procs::DetectorNode node_;
  Run run_;
};

/// Oracle, fixed, adapted.
std::array<Run, 3> drive(const io::Config& config, std::uint64_t seed,
                         const detection::Light& drift) {
  simulation::Simulator simulator(simulation::SceneKind::kOrchard, seed,
                                  {config.laser, config.camera, config.simulation, {}});
  Truth truth;
  for (std::int64_t i = 0; i < simulator.num_scans(); ++i) {
    truth[simulator.scan_utime(i)] = simulator.true_observations(i);
  }
  const double first = static_cast<double>(truth.begin()->first);
  const double duration = static_cast<double>(truth.rbegin()->first) - first;
  std::array<Subject, 3> subjects{Subject(config, false), Subject(config, false),
                                  Subject(config, true)};
  while (const auto sensed = simulator.next()) {
    if (const auto* image = std::get_if<vision::Image>(&*sensed)) {
      const double fraction = (static_cast<double>(image->utime) - first) / duration;
      const vision::Image changed =
          in_light(*image, {fraction * drift.blue, fraction * drift.red, fraction * drift.green});
      subjects[0].handle(*image, truth);
      subjects[1].handle(changed, truth);
      subjects[2].handle(changed, truth);
      continue;
    }
    const bus::Message message = std::visit([](const auto& m) { return bus::Message(m); }, *sensed);
    const bool wanted =
        std::holds_alternative<laser::Scan>(message) ||
        (config.detector.use_odometry && std::holds_alternative<pose::Odometry>(message));
    if (!wanted) continue;
    for (Subject& subject : subjects) subject.handle(message, truth);
  }
  for (Subject& subject : subjects) subject.flush(truth);
  return {subjects[0].run(), subjects[1].run(), subjects[2].run()};
}

void print(const char* name, const Count& count) {
  std::printf("  %-28s F1 %.4f  precision %.4f  recall %.4f\n", name, count.f1(), count.precision(),
              count.recall());
}

void figures(const io::Config& config, std::uint64_t first, std::uint64_t last,
             const detection::Light& drift) {
  std::printf("drift over each run: blue/green x %.2f, red/green x %.2f, green x %.2f\n",
              std::exp(drift.blue), std::exp(drift.red), std::exp(drift.green));
  std::printf("%6s %8s %8s %8s   %s\n", "seed", "oracle", "fixed", "adapted",
              "the model's last state: width, blue, red, green; steps, freezes, roll-backs");
  std::array<Count, 3> sums;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const auto runs = drive(config, seed, drift);
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += runs[i].count;
    const Run& r = runs[2];
    std::printf("%6d %8.4f %8.4f %8.4f   %.4f m %+.3f %+.3f %+.3f; %d, %d, %d\n",
                static_cast<int>(seed), runs[0].count.f1(), runs[1].count.f1(), runs[2].count.f1(),
                r.last.width_mean_m, r.last.light.blue, r.last.light.red, r.last.light.green,
                r.actions[1], r.actions[2], r.actions[4] + r.actions[5]);
    std::fflush(stdout);
  }
  print("oracle (no drift, fixed)", sums[0]);
  print("drift, fixed", sums[1]);
  print("drift, adapted", sums[2]);
  std::printf("  loss against the oracle: fixed %.4f, adapted %.4f\n", sums[0].f1() - sums[1].f1(),
              sums[0].f1() - sums[2].f1());
}

void movement(const io::Config& config, std::uint64_t first, std::uint64_t last, const char* what) {
  std::printf("%s, no drift: how far the model moves at most\n", what);
  std::printf("%6s %8s %8s %10s %8s %8s\n", "seed", "fixed", "adapted", "width mm", "colour",
              "bright");
  std::array<Count, 2> sums;
  Run most;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const auto runs = drive(config, seed, {});
    sums[0] += runs[0].count;
    sums[1] += runs[2].count;
    const Run& r = runs[2];
    most.width_away_m = std::max(most.width_away_m, r.width_away_m);
    most.colour_away = std::max(most.colour_away, r.colour_away);
    most.brightness_away = std::max(most.brightness_away, r.brightness_away);
    std::printf("%6d %8.4f %8.4f %10.1f %8.3f %8.3f\n", static_cast<int>(seed), runs[0].count.f1(),
                r.count.f1(), 1e3 * r.width_away_m, r.colour_away, r.brightness_away);
    std::fflush(stdout);
  }
  print("fixed", sums[0]);
  print("adapted", sums[1]);
  std::printf("  most: width %.1f mm (the rig's sigma %.1f mm), colour %.3f, brightness %.3f\n",
              1e3 * most.width_away_m, 1e3 * config.detector.width.sd_m, most.colour_away,
              most.brightness_away);
}

/// Posts move the model by what it moves further than in the same orchards without any.
void posts(io::Config config, std::uint64_t first, std::uint64_t last) {
  auto& orchard = config.simulation.orchard;
  orchard.post_every_m = 0.0;
  movement(config, first, last, "no posts");
  orchard.wide_post_fraction = 1.0;
  // As many posts as make 30 % of all that stands in the rows.
  orchard.post_every_m = orchard.tree_spacing_m / (1.0 - orchard.missing_fraction) * 0.7 / 0.3;
  movement(config, first, last, "30 % posts as wide as trunks");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4 && argc != 7) {
    std::fprintf(
        stderr,
        "usage: adaptation_figures CONFIG FIRST_SEED LAST_SEED [BLUE RED GREEN]\n"
        "  BLUE, RED: log of the ratio to green at the end of a run; GREEN: log of green\n");
    return 2;
  }
  try {
    const io::Config config = io::load_config(argv[1]);
    const std::uint64_t first = std::strtoull(argv[2], nullptr, 10);
    const std::uint64_t last = std::strtoull(argv[3], nullptr, 10);
    detection::Light drift{0.25, -0.30, -0.35};
    if (argc == 7) drift = {std::atof(argv[4]), std::atof(argv[5]), std::atof(argv[6])};
    figures(config, first, last, drift);
    posts(config, first, last);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "adaptation_figures: %s\n", error.what());
    return 1;
  }
}

// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"

namespace orchard::simulation {
namespace {

constexpr double kBetweenTrees_m = 0.25;  ///< min gap between the trunks of planted trees

class OrchardChanger {
 public:
  OrchardChanger(std::uint64_t seed, const ChangeConfig& config, Scene& scene)
      : random_(seed, Stream::kChange, static_cast<std::uint64_t>(config.seed)),
        config_(config),
        scene_(scene) {
    for (std::size_t i = 0; i < scene.truth.size(); ++i) {
      if (is_tree(scene.truth[i])) trees_.push_back(static_cast<int>(i));
    }
    shuffle(trees_);
  }

  void change() {
    const int num_changed = fraction_of_trees(config_.fraction);
    const std::vector<int> felled(trees_.begin(), trees_.begin() + num_changed);
    const int num_moved = std::min(fraction_of_trees(config_.moved_fraction),
                                   static_cast<int>(trees_.size()) - num_changed);
    grow(num_changed + num_moved);
    for (int i = 0; i < num_moved; ++i) move(trees_[static_cast<std::size_t>(num_changed + i)]);
    relocate_objects();
    fell(felled);
    plant(num_changed);
  }

 private:
  static bool is_tree(const TruthObject& thing) {
    return thing.label == detection::Label::kTree && !thing.moving;
  }

  int fraction_of_trees(double fraction) const {
    return static_cast<int>(std::lround(fraction * static_cast<double>(trees_.size())));
  }

  template <class T>
  void shuffle(std::vector<T>& values) {
    for (std::size_t i = values.size(); i > 1; --i) {
      std::swap(values[i - 1], values[static_cast<std::size_t>(random_.uniform() * i)]);
    }
  }

  bool clear(double x_m, double y_m, double radius_m, int but) const {
    for (std::size_t i = 0; i < scene_.truth.size(); ++i) {
      const TruthObject& other = scene_.truth[i];
      if (static_cast<int>(i) == but || other.moving) continue;
      if (std::hypot(other.x_m - x_m, other.y_m - y_m) <
          radius_m + 0.5 * other.width_m + kBetweenTrees_m) {
        return false;
      }
    }
    return true;
  }

  template <class Function>
  void for_each_part(int target, const Function& function) {
    for (Cylinder& c : scene_.world.cylinders) {
      if (c.target == target) function(c);
    }
  }

  /// Widens trunks; with grown_fraction below 1, none of the first `num_other` trees grow.
  void grow(int num_other) {
    if (config_.growth_m <= 0.0) return;
    std::vector<bool> grows(scene_.truth.size(), config_.grown_fraction >= 1.0);
    const auto first = std::min(trees_.size(), static_cast<std::size_t>(num_other));
    const auto last = std::min(
        trees_.size(), first + static_cast<std::size_t>(fraction_of_trees(config_.grown_fraction)));
    for (std::size_t k = first; k < last; ++k) grows[static_cast<std::size_t>(trees_[k])] = true;
    // In the order of the truth, so that felled trees do not change the growth of others.
    for (std::size_t i = 0; i < scene_.truth.size(); ++i) {
      if (!is_tree(scene_.truth[i]) || !grows[i]) continue;
      const double wider_m =
          std::max(0.0, random_.normal(config_.growth_m, 0.25 * config_.growth_m));
      scene_.truth[i].width_m += wider_m;
      for_each_part(static_cast<int>(i), [&](Cylinder& c) { c.radius_m += 0.5 * wider_m; });
    }
  }

  void move(int tree) {
    for (int attempt = 0; attempt < 50; ++attempt) {
      const double distance_m =
          config_.moved_m +
          (config_.moved_spread_m > 0.0 ? random_.uniform(0.0, config_.moved_spread_m) : 0.0);
      const TruthObject& thing = scene_.truth[static_cast<std::size_t>(tree)];
      if (put(tree, along_row(thing, distance_m))) return;
    }
  }

  struct Place {
    double x_m = 0.0, y_m = 0.0;
  };

  /// A position beside an object along its row, which keeps the robot's path free.
  Place along_row(const TruthObject& thing, double distance_m) {
    const double towards_rad =
        (random_.uniform() < 0.5 ? 0.5 : -0.5) * geometry::kPi + random_.uniform(-0.3, 0.3);
    return {thing.x_m + distance_m * std::cos(towards_rad),
            thing.y_m + distance_m * std::sin(towards_rad)};
  }

  /// Moves an object there if the position is free.
  bool put(int target, const Place& place) {
    TruthObject& thing = scene_.truth[static_cast<std::size_t>(target)];
    if (!clear(place.x_m, place.y_m, 0.5 * thing.width_m, target)) return false;
    const double dx_m = place.x_m - thing.x_m, dy_m = place.y_m - thing.y_m;
    const auto shift = [&](auto& part) {
      part.x_m += dx_m;
      part.y_m += dy_m;
    };
    shift(thing);
    for_each_part(target, shift);
    for (Box& box : scene_.world.boxes) {
      if (box.target == target) shift(box);
    }
    return true;
  }

  /// Moves posts and bushes to another position in a row, beside a tree.
  void relocate_objects() {
    if (config_.objects_fraction <= 0.0 || trees_.empty()) return;
    std::vector<int> objects;
    for (std::size_t i = 0; i < scene_.truth.size(); ++i) {
      const TruthObject& thing = scene_.truth[i];
      if (!thing.moving && thing.label == detection::Label::kObject) {
        objects.push_back(static_cast<int>(i));
      }
    }
    shuffle(objects);
    objects.resize(static_cast<std::size_t>(
        std::lround(config_.objects_fraction * static_cast<double>(objects.size()))));
    for (const int object : objects) {
      for (int attempt = 0; attempt < 200; ++attempt) {
        const auto k = static_cast<std::size_t>(random_.uniform() * trees_.size());
        const TruthObject& tree = scene_.truth[static_cast<std::size_t>(trees_[k])];
        if (put(object, along_row(tree, random_.uniform(0.6, 1.4)))) break;
      }
    }
  }

  void fell(const std::vector<int>& felled) {
    std::vector<bool> gone(scene_.truth.size(), false);
    for (const int tree : felled) gone[static_cast<std::size_t>(tree)] = true;
    std::vector<int> now(scene_.truth.size(), -1);
    std::vector<TruthObject> standing;
    for (std::size_t i = 0; i < gone.size(); ++i) {
      if (gone[i]) continue;
      now[i] = static_cast<int>(standing.size());
      standing.push_back(std::move(scene_.truth[i]));
      scene_.former_targets.push_back(static_cast<int>(i));
    }
    num_former_ = static_cast<int>(scene_.truth.size());
    scene_.truth = std::move(standing);
    const auto renumber = [&](auto& parts) {
      parts.erase(std::remove_if(parts.begin(), parts.end(),
                                 [&](const auto& part) {
                                   return part.target >= 0 &&
                                          gone[static_cast<std::size_t>(part.target)];
                                 }),
                  parts.end());
      for (auto& part : parts) {
        if (part.target >= 0) part.target = now[static_cast<std::size_t>(part.target)];
      }
    };
    renumber(scene_.world.cylinders);
    renumber(scene_.world.boxes);
    renumber(scene_.movers);
    scene_.world.num_targets = static_cast<int>(scene_.truth.size());
  }

  void plant(int num_wanted) {
    Cylinder like;
    for (const Cylinder& c : scene_.world.cylinders) {
      if (c.target >= 0 && is_tree(scene_.truth[static_cast<std::size_t>(c.target)])) {
        like = c;
        break;
      }
    }
    shuffle(scene_.gaps);
    int num_planted = 0;
    for (const TruthObject& gap : scene_.gaps) {
      if (num_planted == num_wanted) break;
      if (!clear(gap.x_m, gap.y_m, 0.5 * gap.width_m, -1)) continue;
      TruthObject tree = gap;
      tree.name = "N" + std::to_string(++num_planted);
      Cylinder trunk = like;
      trunk.x_m = gap.x_m;
      trunk.y_m = gap.y_m;
      trunk.radius_m = 0.5 * gap.width_m;
      trunk.appearance.texture_seed = static_cast<std::uint32_t>(random_.bits());
      insert(tree, trunk);
    }
  }

  /// Inserts an object before the moving ones, which are last.
  void insert(const TruthObject& thing, Cylinder trunk) {
    const int place = static_cast<int>(std::find_if(scene_.truth.begin(), scene_.truth.end(),
                                                    [](const TruthObject& t) { return t.moving; }) -
                                       scene_.truth.begin());
    for (Mover& mover : scene_.movers) ++mover.target;
    trunk.target = place;
    scene_.truth.insert(scene_.truth.begin() + place, thing);
    scene_.former_targets.insert(scene_.former_targets.begin() + place, num_former_++);
    scene_.world.cylinders.push_back(trunk);
    ++scene_.world.num_targets;
  }

  Random random_;
  const ChangeConfig& config_;
  Scene& scene_;
  std::vector<int> trees_;
  int num_former_ = 0;
};

}  // namespace

void change_orchard(std::uint64_t seed, const ChangeConfig& config, Scene& scene) {
  if (config.fraction <= 0.0 && config.moved_fraction <= 0.0 && config.growth_m <= 0.0 &&
      config.objects_fraction <= 0.0) {
    return;
  }
  OrchardChanger(seed, config, scene).change();
}

}  // namespace orchard::simulation

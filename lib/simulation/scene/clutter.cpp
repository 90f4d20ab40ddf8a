// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"

namespace orchard::simulation {
namespace {

constexpr double kRobotHalfWidth_m = 0.6;
constexpr std::uint64_t kTrellisPosts = 1u << 20;  ///< random numbers of posts

/// Converts each bush of a scene from twigs to leaves, into which beams penetrate by `depth_m` on
/// average [m], sometimes through.
void make_bushes_leafy(double depth_m, Scene& scene) {
  std::vector<Cylinder> kept;
  std::vector<char> is_made(scene.truth.size(), 0);
  for (Cylinder c : scene.world.cylinders) {
    const auto target = static_cast<std::size_t>(c.target);
    const bool is_bush = c.target >= 0 && scene.truth[target].name[0] == 'S';
    if (is_bush && is_made[target]) continue;
    if (is_bush) {
      is_made[target] = 1;
      c.x_m = scene.truth[target].x_m;
      c.y_m = scene.truth[target].y_m;
      c.radius_m = 0.5 * scene.truth[target].width_m;
      c.leaf_depth_m = depth_m;
    }
    kept.push_back(c);
  }
  scene.world.cylinders = std::move(kept);
}

class ClutterBuilder {
 public:
  ClutterBuilder(std::uint64_t seed, const SimulationConfig& config, Scene& scene)
      : seed_(seed), config_(config), clutter_(config.clutter), scene_(scene) {
    constexpr double kStep_s = 0.25;
    for (double t_s = 0.0; t_s <= scene.path.duration_s(); t_s += kStep_s) {
      track_.push_back(scene.path.pose_at(t_s));
    }
    for (std::size_t i = 0; i < scene.truth.size(); ++i) {
      if (scene.truth[i].label == detection::Label::kTree) trees_.push_back(scene.truth[i]);
    }
  }

  void build() {
    for (Cylinder& c : scene_.world.cylinders) {
      if (scene_.truth[c.target].name[0] == 'S') c.sway_m = clutter_.bush_sway_m;
    }
    if (clutter_.leaf_depth_m > 0.0) make_bushes_leafy(clutter_.leaf_depth_m, scene_);
    if (clutter_.post_materials) give_posts_materials();
    add_twins();
    add_trunk_posts();
    add_stakes();
    add_crates();
    add_branches();
    if (clutter_.row_end_hedges) add_hedges();
    add_thin(Stream::kGrass, clutter_.grass_per_tree);
    add_thin(Stream::kTwigs, clutter_.twigs_per_tree);
    add_crowns();
    mark_with_reflectors();
    for (int i = 0; i < clutter_.num_people; ++i) add_person(i);
    for (int i = 0; i < clutter_.num_vehicles; ++i) add_vehicle(i);
  }

 private:
  /// Assigns materials to the trellis posts.
  void give_posts_materials() {
    for (std::size_t i = 0; i < scene_.world.cylinders.size(); ++i) {
      Cylinder& c = scene_.world.cylinders[i];
      if (scene_.truth[c.target].name[0] != 'P') continue;
      Random random(seed_, Stream::kPosts, kTrellisPosts + i);
      c.appearance = post_appearance(random);
    }
  }

  void add_twins() {
    for (std::size_t i = 0; i < trees_.size(); ++i) {
      Random random(seed_, Stream::kTwins, i);
      if (random.uniform() >= clutter_.twin_fraction) continue;
      const TruthObject& tree = trees_[i];
      Cylinder stem = scene_.world.cylinders[cylinder_of(tree)];
      stem.radius_m *= random.uniform(0.7, 1.0);
      const double apart_m = 0.5 * tree.width_m + stem.radius_m + random.uniform(0.0, 0.01);
      const double towards_rad =
          (random.uniform() < 0.5 ? 0.5 : -0.5) * geometry::kPi + random.uniform(-1.0, 1.0);
      stem.x_m += apart_m * std::cos(towards_rad);
      stem.y_m += apart_m * std::sin(towards_rad);
      stem.appearance.texture_seed = static_cast<std::uint32_t>(random.bits());
      scene_.add(stem, detection::Label::kTree, "T" + std::to_string(trees_.size() + ++num_twins_));
    }
  }

  void add_trunk_posts() {
    const OrchardConfig& orchard = config_.orchard;
    for (std::size_t i = 0; i < trees_.size(); ++i) {
      Random random(seed_, Stream::kPosts, i);
      if (random.uniform() >= clutter_.trunk_post_fraction) continue;
      Cylinder post;
      const double width_m =
          std::clamp(random.normal(orchard.trunk_width_m, orchard.trunk_width_sd_m),
                     0.6 * orchard.trunk_width_m, 1.5 * orchard.trunk_width_m);
      post.radius_m = 0.5 * width_m;
      post.height_m = random.uniform(1.4, 2.2);
      post.appearance = post_appearance(random);
      for (const double fraction : {0.5, 0.35, 0.65}) {
        post.x_m = trees_[i].x_m + random.uniform(-0.08, 0.08);
        post.y_m = trees_[i].y_m + fraction * orchard.tree_spacing_m;
        if (!scene_.is_clear(post.x_m, post.y_m, post.radius_m + 0.2)) continue;
        scene_.add(post, detection::Label::kObject, "P" + std::to_string(++num_posts_));
        break;
      }
    }
  }

  /// Appearance of a post of galvanized steel, weathered timber, treated timber or concrete.
  static Appearance post_appearance(Random& random) {
    Appearance appearance;
    appearance.texture = Appearance::Texture::kWood;
    appearance.texture_seed = static_cast<std::uint32_t>(random.bits());
    const double kind = random.uniform();
    const auto paint = [&](double hue, double hue_sd, double saturation, double value) {
      appearance.hue_deg = hue + random.uniform(-hue_sd, hue_sd);
      appearance.saturation = saturation * random.uniform(0.7, 1.3);
      appearance.value = value * random.uniform(0.85, 1.15);
    };
    if (kind < 0.25) {
      paint(215.0, 15.0, 0.08, 0.72);
      appearance.reflectivity = 0.6;
    } else if (kind < 0.5) {
      paint(38.0, 10.0, 0.10, 0.62);
      appearance.reflectivity = 0.4;
    } else if (kind < 0.75) {
      paint(85.0, 20.0, 0.24, 0.50);
      appearance.reflectivity = 0.35;
    } else {
      paint(48.0, 10.0, 0.05, 0.76);
      appearance.reflectivity = 0.5;
    }
    return appearance;
  }

  void add_stakes() {
    for (std::size_t i = 0; i < trees_.size(); ++i) {
      Random random(seed_, Stream::kStakes, i);
      if (random.uniform() >= clutter_.stake_fraction) continue;
      Cylinder stake;
      stake.radius_m = random.uniform(0.010, 0.020);
      stake.height_m = random.uniform(1.0, 1.8);
      stake.appearance = draw_appearance(random, {35.0, 52.0}, {0.15, 0.40}, {0.50, 0.80},
                                         Appearance::Texture::kWood);
      const double away_m = 0.5 * trees_[i].width_m + stake.radius_m + random.uniform(0.03, 0.20);
      const double towards_rad = random.uniform(-geometry::kPi, geometry::kPi);
      stake.x_m = trees_[i].x_m + away_m * std::cos(towards_rad);
      stake.y_m = trees_[i].y_m + away_m * std::sin(towards_rad);
      scene_.add(stake, detection::Label::kObject, "K" + std::to_string(i + 1));
    }
  }

  void add_crates() {
    for (int i = 0; i < clutter_.num_crates; ++i) {
      Random random(seed_, Stream::kCrates, i);
      const bool bin = random.uniform() < 0.4;  // a bulk bin, or stacked picking crates
      Box crate = bin ? Box{0, 0, 0, 1.20, 1.00, 0.76} : Box{0, 0, 0, 0.60, 0.40, 0.93};
      crate.appearance = draw_appearance(random, bin ? Limits{28.0, 45.0} : Limits{100.0, 240.0},
                                         bin ? Limits{0.2, 0.4} : Limits{0.4, 0.8}, {0.45, 0.75},
                                         Appearance::Texture::kWood);
      place_box(random, crate, 0.6, detection::Label::kObject, "C" + std::to_string(i + 1));
    }
  }

  void add_branches() {
    for (int i = 0; i < clutter_.num_branches; ++i) {
      Random random(seed_, Stream::kBranches, i);
      Box branch;  // raised by its own twigs
      branch.length_m = random.uniform(0.5, 1.4);
      branch.width_m = random.uniform(0.03, 0.07);
      branch.base_m = std::max(0.0, config_.scanner.height_m - random.uniform(0.02, 0.15));
      branch.height_m = config_.scanner.height_m - branch.base_m + random.uniform(0.02, 0.05);
      branch.appearance = draw_appearance(random, {25.0, 60.0}, {0.1, 0.35}, {0.30, 0.55},
                                          Appearance::Texture::kRoughBark);
      place_box(random, branch, 1.0, detection::Label::kObject, "F" + std::to_string(i + 1));
    }
  }

  /// Places a box at a free position within `beside_m` of a row; drops it if none is found.
  void place_box(Random& random, Box box, double beside_m, detection::Label label,
                 const std::string& name) {
    const OrchardConfig& orchard = config_.orchard;
    const double reach_m = 0.5 * std::hypot(box.length_m, box.width_m);
    for (int attempt = 0; attempt < 200; ++attempt) {
      const int row = static_cast<int>(random.uniform() * orchard.num_rows);
      box.x_m = (row - 0.5) * orchard.row_spacing_m + random.uniform(-beside_m, beside_m);
      box.y_m = random.uniform(first_y_m(), last_y_m());
      box.yaw_rad = random.uniform(-geometry::kPi, geometry::kPi);
      box.appearance.texture_seed = static_cast<std::uint32_t>(random.bits());
      if (!scene_.is_clear(box.x_m, box.y_m, reach_m + 0.1) || on_track(box.x_m, box.y_m, reach_m))
        continue;
      box.target = scene_.world.num_targets++;
      scene_.truth.push_back({label, box.x_m, box.y_m, box.length_m, name});
      scene_.world.boxes.push_back(box);
      return;
    }
  }

  /// Adds hedges in pieces of one metre, each an object of its own.
  void add_hedges() {
    double low_m = first_y_m(), high_m = last_y_m();
    for (const Pose2& pose : track_) {
      low_m = std::min(low_m, pose.y_m);
      high_m = std::max(high_m, pose.y_m);
    }
    const double x_min_m = -config_.orchard.row_spacing_m;
    const double x_max_m = config_.orchard.row_spacing_m * config_.orchard.num_rows;
    int num_pieces = 0;
    for (const double y_m : {low_m - 1.8, high_m + 1.8}) {
      Random random(seed_, Stream::kHedges, y_m < 0.0 ? 0 : 1);
      for (double x_m = x_min_m; x_m < x_max_m; x_m += 1.0) {
        Box piece;
        piece.x_m = x_m + 0.5;
        piece.y_m = y_m + random.uniform(-0.1, 0.1);
        piece.yaw_rad = random.uniform(-0.1, 0.1);
        piece.length_m = 1.0;
        piece.width_m = random.uniform(0.4, 0.7);
        piece.height_m = random.uniform(1.5, 2.0);
        piece.appearance = draw_appearance(random, {85.0, 120.0}, {0.35, 0.6}, {0.25, 0.45},
                                           Appearance::Texture::kLeaves);
        piece.appearance.texture_seed = static_cast<std::uint32_t>(random.bits());
        piece.target = scene_.world.num_targets++;
        scene_.truth.push_back({detection::Label::kObject, piece.x_m, piece.y_m, piece.length_m,
                                "H" + std::to_string(++num_pieces)});
        scene_.world.boxes.push_back(piece);
      }
    }
  }

  /// Adds stalks or twigs that reach the scan plane near trunks; they are not in the truth.
  void add_thin(Stream stream, double mean) {
    const bool grass = stream == Stream::kGrass;
    const double scan_m = config_.scanner.height_m;
    for (std::size_t i = 0; i < trees_.size(); ++i) {
      Random random(seed_, stream, i);
      const int n = static_cast<int>(2.0 * mean * random.uniform() + 0.5);
      for (int k = 0; k < n; ++k) {
        Cylinder stalk;
        const double away_m = 0.5 * trees_[i].width_m +
                              (grass ? random.uniform(0.03, 0.60) : random.uniform(0.05, 0.80));
        const double towards_rad = random.uniform(-geometry::kPi, geometry::kPi);
        stalk.x_m = trees_[i].x_m + away_m * std::cos(towards_rad);
        stalk.y_m = trees_[i].y_m + away_m * std::sin(towards_rad);
        stalk.radius_m = grass ? random.uniform(0.001, 0.0025) : random.uniform(0.002, 0.005);
        stalk.base_m = grass ? 0.0 : scan_m - random.uniform(0.02, 0.25);
        stalk.height_m = grass ? scan_m + random.uniform(0.02, 0.25) : random.uniform(0.6, 1.0);
        stalk.sway_m = clutter_.sway_m;
        stalk.target = -1;
        stalk.appearance =
            draw_appearance(random, grass ? Limits{48.0, 100.0} : Limits{20.0, 45.0}, {0.25, 0.55},
                            grass ? Limits{0.4, 0.7} : Limits{0.2, 0.4});
        stalk.appearance.texture_seed = static_cast<std::uint32_t>(random.bits());
        scene_.world.cylinders.push_back(stalk);
      }
    }
  }

  void add_crowns() {
    if (clutter_.foliage <= 0.0) return;
    for (std::size_t i = 0; i < trees_.size(); ++i) {
      Random random(seed_, Stream::kCrowns, i);
      Crown crown;
      crown.foliage = clutter_.foliage;
      crown.appearance = draw_appearance(random, {75.0, 112.0}, {0.35, 0.65}, {0.35, 0.60},
                                         Appearance::Texture::kLeaves);
      for (int ball = 0; ball < 3; ++ball) {
        crown.x_m = trees_[i].x_m + random.uniform(-0.45, 0.45);
        crown.y_m = trees_[i].y_m + random.uniform(-0.55, 0.55);
        crown.radius_m = random.uniform(0.45, 0.8);
        crown.z_m = random.uniform(1.75, 2.4);
        crown.appearance.texture_seed = static_cast<std::uint32_t>(random.bits());
        scene_.world.crowns.push_back(crown);
      }
    }
  }

  void mark_with_reflectors() {
    for (Cylinder& c : scene_.world.cylinders) {
      if (c.target < 0) continue;
      const char kind = scene_.truth[c.target].name[0];
      const double fraction = kind == 'T'   ? clutter_.reflector_tree_fraction
                              : kind == 'P' ? clutter_.reflector_post_fraction
                                            : 0.0;
      Random random(seed_, Stream::kReflectors, static_cast<std::uint64_t>(c.target));
      if (random.uniform() < fraction) c.appearance.reflectivity = 8.0;
    }
  }

  /// Adds a person who crosses 4 to 8 m ahead of the robot or walks along the aisle there; or walks
  /// in the robot's direction beside or behind it; or stands until the robot has passed.
  void add_person(int index) {
    Random random(seed_, Stream::kPeople, static_cast<std::uint64_t>(index));
    for (int attempt = 0; attempt < 200; ++attempt) {
      const double time_s = random.uniform(2.0, std::max(4.0, scene_.path.duration_s() - 4.0));
      const Pose2 robot = scene_.path.pose_at(time_s);
      double ahead_m = random.uniform(4.0, 8.0);
      bool crosses = random.uniform() < 0.5;
      const double side = random.uniform() < 0.5 ? -1.0 : 1.0;
      double beside_m = crosses ? 0.0 : side * random.uniform(0.9, 1.2);
      const int how = clutter_.people_around ? index % 3 : 0;
      if (how > 0) {
        crosses = false;
        beside_m = side * random.uniform(1.0, 1.3);
        ahead_m = how == 1 ? random.uniform(-3.0, 1.0) : -random.uniform(1.0, 4.0);
      }
      const Pose2 meeting = compose(robot, {ahead_m, beside_m, 0.0});
      Mover person;
      person.heading_rad =
          crosses ? (side > 0.0 ? 0.0 : geometry::kPi) : side * 0.5 * geometry::kPi;
      person.speed_mps = clutter_.person_speed_mps * random.uniform(0.8, 1.2);
      if (how > 0) person.heading_rad = robot.yaw_rad;
      if (how == 1) person.speed_mps = config_.orchard.speed_mps * random.uniform(0.9, 1.1);
      if (how == 2) person.starts_s = time_s;
      const double walked_m = person.speed_mps * (time_s - person.starts_s);
      person.x_m = meeting.x_m - walked_m * std::cos(person.heading_rad);
      person.y_m = meeting.y_m - walked_m * std::sin(person.heading_rad);
      person.clothes = draw_appearance(random, {0.0, 360.0}, {0.1, 0.6}, {0.15, 0.7});
      person.clothes.texture_seed = static_cast<std::uint32_t>(random.bits());
      if (is_free(person)) return add_mover(person, 0.32, "M" + std::to_string(index + 1));
    }
  }

  /// Adds a vehicle that stands ahead in an aisle and leaves when the robot is 5 m away.
  void add_vehicle(int index) {
    Random random(seed_, Stream::kVehicles, static_cast<std::uint64_t>(index));
    for (int attempt = 0; attempt < 200; ++attempt) {
      Mover vehicle;
      vehicle.kind = Mover::Kind::kVehicle;
      vehicle.starts_s = random.uniform(2.0, std::max(4.0, scene_.path.duration_s() - 4.0));
      const Pose2 robot = scene_.path.pose_at(vehicle.starts_s);
      if (std::abs(std::cos(robot.yaw_rad)) > 0.02) continue;
      const Pose2 place = compose(robot, {5.0, random.uniform(-0.4, 0.4), 0.0});
      vehicle.x_m = place.x_m;
      vehicle.y_m = place.y_m;
      vehicle.heading_rad = robot.yaw_rad;
      vehicle.speed_mps = clutter_.vehicle_speed_mps;
      if (place.y_m < first_y_m() || place.y_m > last_y_m() || !is_free(vehicle)) continue;
      return add_mover(vehicle, 1.1, "V" + std::to_string(index + 1));
    }
  }

  void add_mover(Mover mover, double width_m, const std::string& name) {
    mover.target = scene_.world.num_targets++;
    scene_.truth.push_back(
        {detection::Label::kObject, mover.x_m, mover.y_m, width_m, name, /*moving=*/true});
    scene_.movers.push_back(mover);
  }

  /// True if it meets no object of the truth except hedges, which have gates, and keeps away from
  /// the robot's centre: a person 0.8 m, a vehicle 3 m.
  bool is_free(const Mover& mover) const {
    const bool walks = mover.kind == Mover::Kind::kPerson;
    const double c = std::cos(mover.heading_rad), s = std::sin(mover.heading_rad);
    const double begin_m = walks ? -1.0 : -1.2, beside_m = walks ? 0.30 : 0.7;
    const double end_m = walks ? mover.speed_mps * scene_.path.duration_s() + 1.0
                               : std::numeric_limits<double>::infinity();
    for (const TruthObject& thing : scene_.truth) {
      const double ex = thing.x_m - mover.x_m, ey = thing.y_m - mover.y_m;
      const double along_m = ex * c + ey * s;
      if (thing.moving || along_m < begin_m || along_m > end_m || thing.name[0] == 'H') continue;
      if (std::abs(ex * s - ey * c) < 0.5 * thing.width_m + beside_m) return false;
    }
    const double starting_s = walks ? 0.0 : 2.0;  // a bound of the time that it loses
    for (double t_s = 0.0; t_s < scene_.path.duration_s(); t_s += 0.25) {
      const Pose2 robot = scene_.path.pose_at(t_s);
      const double way_m = mover.speed_mps * std::max(0.0, t_s - mover.starts_s - starting_s);
      const double x_m = mover.x_m + c * way_m, y_m = mover.y_m + s * way_m;
      if (std::hypot(x_m - robot.x_m, y_m - robot.y_m) < (walks ? 0.8 : 3.0)) return false;
    }
    return true;
  }

  bool on_track(double x_m, double y_m, double reach_m) const {
    return std::any_of(track_.begin(), track_.end(), [&](const Pose2& pose) {
      return std::hypot(pose.x_m - x_m, pose.y_m - y_m) < reach_m + kRobotHalfWidth_m;
    });
  }

  std::size_t cylinder_of(const TruthObject& tree) const {
    const auto& all = scene_.world.cylinders;
    const auto found = std::find_if(all.begin(), all.end(), [&](const Cylinder& c) {
      return c.x_m == tree.x_m && c.y_m == tree.y_m;
    });
    return static_cast<std::size_t>(found - all.begin());
  }

  double first_y_m() const { return trees_.empty() ? 0.0 : extreme_y(false); }
  double last_y_m() const { return trees_.empty() ? 1.0 : extreme_y(true); }
  double extreme_y(bool last) const {
    const auto less = [](const TruthObject& a, const TruthObject& b) { return a.y_m < b.y_m; };
    return last ? std::max_element(trees_.begin(), trees_.end(), less)->y_m
                : std::min_element(trees_.begin(), trees_.end(), less)->y_m;
  }

  std::uint64_t seed_;
  const SimulationConfig& config_;
  const ClutterConfig& clutter_;
  Scene& scene_;
  std::vector<Pose2> track_;
  std::vector<TruthObject> trees_;  ///< as planted, without second stems
  int num_twins_ = 0;
  int num_posts_ = 1000;  // distinct from the trellis posts' numbers
};

}  // namespace

void add_clutter(std::uint64_t seed, const SimulationConfig& config, Scene& scene) {
  ClutterBuilder(seed, config, scene).build();
}

}  // namespace orchard::simulation

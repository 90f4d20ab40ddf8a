// SPDX-License-Identifier: BSD-3-Clause
#include "detection/detect.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "detection/detection.hpp"
#include "detection/picture_width.hpp"
#include "detection/probability.hpp"
#include "detection/trunk_view.hpp"
#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "laser/segment.hpp"
#include "vision/appearance.hpp"
#include "vision/colour.hpp"
#include "vision/edges.hpp"

namespace orchard::detection {
namespace {

enum class LaserDecision { kCandidate, kObject, kHidden };

/// Result of the reflector test; kUntold if reflectors are used but the scan has no intensities.
enum class ReflectorDecision { kNothing, kNoTree, kUntold };

ReflectorDecision judge_by_reflector(const laser::Segment& segment, const laser::Scan& scan,
                                     const laser::SegmentationConfig& config) {
  if (config.reflector == laser::ReflectorUse::kIgnored) return ReflectorDecision::kNothing;
  if (!scan.has_intensities()) return ReflectorDecision::kUntold;
  const bool marks_trees = config.reflector == laser::ReflectorUse::kOnly;
  return segment.is_reflector == marks_trees ? ReflectorDecision::kNothing
                                             : ReflectorDecision::kNoTree;
}

bool is_half_hidden(const laser::Segment& segment) {
  return segment.occluded_left || segment.occluded_right;
}

/// physical: beams on either side into which a reflector blooms.
constexpr int kBloom_beams = 1;

/// Whether an object is a trunk because it carries a reflector, even if it is hidden or fails the
/// width test. A reflector appears wider by one beam on either side (blooming); an object that is
/// too wide even after subtracting this is not a trunk, for example a sheet of metal. A beam half
/// on a nearer object and half on a reflector reads a range between them, where nothing is: it and
/// the beam into which it blooms may be one.
bool stands_by_reflector(const laser::Segment& segment, const laser::Scan& scan,
                         const DetectorConfig& config) {
  if (config.segmentation.reflector != laser::ReflectorUse::kOnly || !segment.is_reflector) {
    return false;
  }
  if (is_half_hidden(segment) && segment.num_beams <= 1 + kBloom_beams) return false;
  const double bloom_m = 2.0 * kBloom_beams * segment.range_m * std::abs(scan.bearing_step_rad);
  const double least_m = segment.width_m - bloom_m;
  return least_m <= config.width.mean_m ||
         laser::roc_laser(least_m, segment.range_m, scan.bearing_step_rad, config.width) >=
             DetectorConfig::kRocLaserMin;
}

/// roc_laser of an object's width. The width of a half-hidden object comes from the curvature of
/// its circle, so its uncertainty is added to the model's sigma.
double roc_of_width(const laser::Segment& segment, double bearing_step_rad,
                    const DetectorConfig& config) {
  if (!is_half_hidden(segment) || !segment.circle || config.visible_fraction_min >= 1.0) {
    return laser::roc_laser(segment.width_m, segment.range_m, bearing_step_rad, config.width);
  }
  laser::WidthConfig measured = config.width;
  measured.sd_m =
      std::hypot(std::max(measured.sd_m, laser::WidthConfig::kSdFloor_m), segment.width_sd_m);
  return laser::roc_laser(segment.width_m, segment.range_m, bearing_step_rad, measured);
}

/// Visible fraction of an object if it is a trunk. The trunk's width is the variance-weighted mean
/// of the circle's and the model's.
double visible_fraction(const laser::Segment& segment, const laser::WidthConfig& trunks) {
  if (!segment.circle) return segment.width_m / trunks.mean_m;
  const double model_m2 = std::pow(std::max(trunks.sd_m, laser::WidthConfig::kSdFloor_m), 2);
  const double weight = model_m2 / (model_m2 + segment.width_sd_m * segment.width_sd_m);
  const double width_m = trunks.mean_m + weight * (segment.width_m - trunks.mean_m);
  return segment.visible_fraction * segment.width_m / width_m;
}

/// Classifies an object by its width. The visible width of a half-hidden object, or its circle's
/// width less 2 sigma, is a lower bound: if too wide it is an object, otherwise undecided (kHidden)
/// unless at least visible_fraction_min of a trunk is visible.
LaserDecision judge_by_laser(const laser::Segment& segment, double roc_laser,
                             double bearing_step_rad, const DetectorConfig& config) {
  if (is_half_hidden(segment)) {
    const double least_width_m =
        segment.circle ? segment.width_m - 2.0 * segment.width_sd_m : segment.width_m;
    const bool too_wide = least_width_m > config.width.mean_m &&
                          laser::roc_laser(least_width_m, segment.range_m, bearing_step_rad,
                                           config.width) < DetectorConfig::kRocLaserMin;
    if (too_wide) return LaserDecision::kObject;
    const bool shows = config.visible_fraction_min < 1.0 &&
                       roc_laser >= DetectorConfig::kRocLaserMin &&
                       visible_fraction(segment, config.width) >= config.visible_fraction_min;
    return shows ? LaserDecision::kCandidate : LaserDecision::kHidden;
  }
  return roc_laser >= DetectorConfig::kRocLaserMin ? LaserDecision::kCandidate
                                                   : LaserDecision::kObject;
}

Detection laser_detection(const laser::Segment& segment, const laser::Scan& scan, double roc_laser,
                          LaserDecision decision, const Rig& rig) {
  Detection d;
  d.utime =
      scan.utime + std::llround(static_cast<double>(segment.middle_beam) * scan.beam_period_us);
  d.range_m = segment.range_m;
  d.bearing_rad = segment.bearing_rad;
  d.width_m = segment.width_m;
  d.width_sd_m = segment.width_sd_m;
  d.num_beams = segment.num_beams;
  d.intensity = static_cast<float>(std::max(segment.intensity, 0.0));
  d.occlusion = static_cast<std::int8_t>((segment.occluded_right ? kOccludedRight : 0) |
                                         (segment.occluded_left ? kOccludedLeft : 0));
  d.roc_laser = static_cast<float>(roc_laser);
  place_in_base(d, segment, scan, decision != LaserDecision::kObject, rig);
  return d;
}

/// Decoded pixels of an image, and their edge map, computed when first needed.
struct Pixels {
  vision::PixelBlock block;
  vision::PixelRect windows;  ///< area of the edge map
  std::optional<vision::EdgeMap> edges;
};

struct ColourVerdict {
  bool passed = false;
  double roc = 0.0;
};

ColourVerdict judge_colour(const TrunkView& view, const vision::PixelBlock& pixels,
                           const Rig& rig) {
  const DetectorConfig& config = rig.detector;
  if (config.colour_model == ColourModel::kAppearance) {
    const auto features = vision::appearance_features(pixels, trunk_window(view, rig));
    const double confidence = vision::appearance_confidence(features, config.appearance);
    return {confidence >= config.appearance.confidence_min, confidence};
  }
  const auto hues = vision::hue_histogram(pixels, view.centre);
  const vision::ColourEvidence colour = vision::colour_confidence(hues, config.colour);
  return {colour.passed, colour.roc};
}

/// Tests colour and, if it passes, edges. Fills the confidences of `d` and, where the picture knows
/// more of its width than the laser, that; returns roc_vision.
double judge_by_vision(Detection& d, const Candidate& candidate, const TrunkView& view,
                       Pixels& pixels, const Rig& rig) {
  const DetectorConfig& config = rig.detector;
  const ColourVerdict colour = judge_colour(view, pixels.block, rig);
  d.roc_colour = static_cast<float>(colour.roc);
  if (!colour.passed) return 0.0;

  if (!pixels.edges) pixels.edges = vision::edge_map(pixels.block, pixels.windows, config.edges);
  const auto left = vision::find_edge(*pixels.edges, view.left_edge, view.left_x_px, config.edges);
  const auto right =
      vision::find_edge(*pixels.edges, view.right_edge, view.right_x_px, config.edges);
  const double parallel = vision::parallel_confidence(left, right);
  const double edges = fuse_edges(left.roc, right.roc, parallel);
  d.roc_left_edge = static_cast<float>(left.roc);
  d.roc_right_edge = static_cast<float>(right.roc);
  d.roc_parallel = static_cast<float>(parallel);
  d.roc_edges = static_cast<float>(edges);
  if (const auto width =
          picture_width(*pixels.edges, view, candidate.segment, candidate.angle_sd_rad, rig)) {
    d.width_m = width->fused.width_m;
    d.width_sd_m = width->fused.sd_m;
  }
  return fuse_vision(colour.roc, edges, DetectorConfig::kColourWeight);
}

void decide(Detection& d, double roc_tree, const Rig& rig) {
  d.roc_tree = static_cast<float>(roc_tree);
  d.label = label_of(roc_tree, rig.detector.tree_threshold);
}

/// Whether the camera could still make a tree of an object that the laser rejects by its width.
/// With Decision::kProbability the width is one feature among others: the surest answer of a camera
/// is tried, and if even that leaves the object below tree_min, no picture needs to be read.
bool camera_could_decide(Detection d, const DetectorConfig& config) {
  if (config.decision != Decision::kProbability) return false;
  d.label = Label::kObject;
  d.roc_colour = 1.0f;
  d.roc_edges = 1.0f;
  return tree_probability(d, config.width.mean_m, config.probability).tree >=
         config.probability.tree_min;
}

/// Sets the probabilities of all detections, and their labels with Decision::kProbability.
void judge_probabilities(std::vector<Detection>& trunks, const Rig& rig) {
  const DetectorConfig& config = rig.detector;
  if (!config.probability.enabled) return;
  for (Detection& d : trunks) {
    const auto p = tree_probability(d, config.width.mean_m, config.probability);
    d.probability_tree = static_cast<float>(p.tree);
    d.probability_object = static_cast<float>(p.object);
    if (config.decision != Decision::kProbability || d.label == Label::kUnseen) continue;
    // An object rejected by the laser stays an OBJECT unless the camera has examined it.
    const bool examined = d.roc_colour > 0.0f || d.roc_laser >= DetectorConfig::kRocLaserMin;
    if (rig.has_camera && !examined) continue;
    d.label = label_of(p.tree, config.probability.tree_min);
  }
}

bool fits_camera(const vision::Image& image, const Rig& rig) {
  return image.width_px == rig.camera.intrinsics().width_px &&
         image.height_px == rig.camera.intrinsics().height_px;
}

}  // namespace

LaserFindings find_by_laser(const laser::Scan& scan, const Rig& rig) {
  const DetectorConfig& config = rig.detector;
  LaserFindings findings;
  findings.detections.utime = scan.utime;
  findings.intensities_missing =
      config.segmentation.reflector != laser::ReflectorUse::kIgnored && !scan.has_intensities();
  findings.beam_period_s = 1e-6 * scan.beam_period_us;
  findings.plane_of_level = scan.plane_of_level;
  std::vector<Detection>& trunks = findings.detections.trunks;
  const auto segments = laser::segment(scan, config.segmentation, config.width, rig.laser,
                                       DetectorConfig::kRocLaserMin);
  trunks.reserve(segments.size());
  const double angle_sd_rad = config.width.sd_per_beam_step * std::abs(scan.bearing_step_rad);
  for (const laser::Segment& segment : segments) {
    const bool stands = stands_by_reflector(segment, scan, config);
    const double roc_laser = stands ? 1.0 : roc_of_width(segment, scan.bearing_step_rad, config);
    const ReflectorDecision reflector = judge_by_reflector(segment, scan, config.segmentation);
    LaserDecision decision =
        stands ? LaserDecision::kCandidate
               : judge_by_laser(segment, roc_laser, scan.bearing_step_rad, config);
    if (reflector == ReflectorDecision::kNoTree) decision = LaserDecision::kObject;
    if (reflector == ReflectorDecision::kUntold) decision = LaserDecision::kHidden;
    trunks.push_back(laser_detection(segment, scan, roc_laser, decision, rig));
    if (decision == LaserDecision::kHidden) continue;
    if (!rig.has_camera && reflector == ReflectorDecision::kNoTree) {
      trunks.back().label = Label::kObject;
    } else if (!rig.has_camera) {
      decide(trunks.back(), roc_laser, rig);
    } else if (decision == LaserDecision::kObject) {
      trunks.back().label = Label::kObject;
      trunks.back().roc_tree =
          static_cast<float>(fuse_tree(roc_laser, 0.0, DetectorConfig::kLaserWeight));
      if (reflector == ReflectorDecision::kNothing && !is_half_hidden(segment) &&
          camera_could_decide(trunks.back(), config)) {
        findings.candidates.push_back({trunks.size() - 1, segment, angle_sd_rad});
      }
    } else {
      findings.candidates.push_back({trunks.size() - 1, segment, angle_sd_rad});
    }
  }
  return findings;
}

ScanToPicture to_picture(const LaserFindings& findings, const vision::Image& image, const Rig& rig,
                         const std::optional<Motion>& motion) {
  const double stamped_dt_s = 1e-6 * static_cast<double>(image.utime - findings.detections.utime);
  return {motion, stamped_dt_s - rig.camera_delay_s, findings.beam_period_s,
          findings.plane_of_level};
}

namespace {

DetectResult judge_candidates(LaserFindings findings, vision::PictureReader* picture,
                              const Rig& rig, const std::optional<Motion>& motion) {
  DetectResult result;
  const ScanToPicture to_exposure =
      picture ? to_picture(findings, picture->image(), rig, motion) : ScanToPicture();
  result.detections = std::move(findings.detections);
  result.intensities_missing = findings.intensities_missing;
  if (!rig.has_camera || !picture) return result;
  result.detections.image_utime = picture->image().utime;
  std::vector<Detection>& trunks = result.detections.trunks;

  std::vector<std::optional<TrunkView>> views(findings.candidates.size());
  vision::PixelRect reading, windows;
  for (std::size_t i = 0; i < views.size(); ++i) {
    views[i] = view_of(findings.candidates[i].segment, rig, to_exposure);
    if (!views[i]) continue;
    reading = vision::bounding(reading, reading_area(*views[i], rig));
    windows = vision::bounding(windows, windows_area(*views[i], rig));
  }
  if (reading.empty()) return result;
  result.image_needed = true;

  auto pixels = fits_camera(picture->image(), rig) ? picture->read(reading) : std::nullopt;
  result.image_unusable = !pixels.has_value();
  if (!pixels) return result;
  if (rig.detector.colour_model == ColourModel::kAppearance) vision::normalise_exposure(*pixels);
  Pixels seen{std::move(*pixels), windows, std::nullopt};
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!views[i]) continue;
    const Candidate& candidate = findings.candidates[i];
    Detection& d = trunks[candidate.index];
    const double roc_vision = judge_by_vision(d, candidate, *views[i], seen, rig);
    d.roc_vision = static_cast<float>(roc_vision);
    decide(d, fuse_tree(d.roc_laser, roc_vision, DetectorConfig::kLaserWeight), rig);
  }
  return result;
}

}  // namespace

DetectResult judge_by_camera(LaserFindings findings, vision::PictureReader* picture, const Rig& rig,
                             const std::optional<Motion>& motion) {
  DetectResult result = judge_candidates(std::move(findings), picture, rig, motion);
  judge_probabilities(result.detections.trunks, rig);
  return result;
}

DetectResult detect(const laser::Scan& scan, const vision::Image* image, const Rig& rig,
                    const std::optional<Motion>& motion) {
  if (!image) return judge_by_camera(find_by_laser(scan, rig), nullptr, rig, motion);
  vision::PictureReader picture(*image);
  return judge_by_camera(find_by_laser(scan, rig), &picture, rig, motion);
}

namespace {

struct Estimate {
  double mean = 0.0;
  double variance = 0.0;
};

/// Mean and variance of a trunk's radius in the width model.
Estimate model_radius(const Rig& rig) {
  const laser::WidthConfig& trunks = rig.detector.width;
  return {0.5 * trunks.mean_m,
          0.25 * geometry::square(std::max(trunks.sd_m, laser::WidthConfig::kSdFloor_m))};
}

Estimate radius_of(const laser::Segment& segment, bool is_trunk, const Rig& rig) {
  const Estimate measured{0.5 * segment.width_m,
                          0.25 * geometry::square(std::max(segment.width_sd_m, 1e-4))};
  if (!is_trunk) return measured;
  const Estimate model = model_radius(rig);
  const double weight = model.variance / (model.variance + measured.variance);
  return {model.mean + weight * (measured.mean - model.mean), weight * measured.variance};
}

/// A position in the laser frame and its covariance xx xy yy.
struct Place {
  double x_m = 0.0, y_m = 0.0;
  std::array<double, 3> covariance{};
};

/// Centre without a circle: range to the bark plus radius, at the bearing of the visible middle.
Place by_range(const laser::Segment& segment, const laser::Scan& scan, bool is_trunk, bool hidden,
               const Rig& rig) {
  const Estimate radius = radius_of(segment, is_trunk, rig);
  const double c = std::cos(segment.bearing_rad), s = std::sin(segment.bearing_rad);
  const double range_m = segment.range_m + radius.mean;
  const double along_m2 =
      geometry::square(rig.laser.range_sd_at(segment.range_m)) / std::max(segment.num_beams, 1) +
      radius.variance;
  // Each side is uniform within one beam step, and the middle is the mean of both. With a hidden
  // side the visible middle may be off by half a trunk's width.
  double across_m2 = geometry::square(range_m * scan.bearing_step_rad) / 12.0;
  if (hidden) {
    across_m2 += geometry::square(0.5 * rig.detector.width.mean_m);
  }
  return {range_m * c,
          range_m * s,
          {c * c * along_m2 + s * s * across_m2, c * s * (along_m2 - across_m2),
           s * s * along_m2 + c * c * across_m2}};
}

/// Centre by the circle. For a trunk, a Kalman update with the model's radius corrects it.
Place by_circle(const laser::CircleFit& circle, bool is_trunk, const Rig& rig) {
  const auto& [xx, xy, yy, xr, yr, rr] = circle.covariance;
  if (!is_trunk) return {circle.x_m, circle.y_m, {xx, xy, yy}};
  const Estimate model = model_radius(rig);
  const double innovation_m = model.mean - circle.radius_m;
  const double total_m2 = rr + model.variance;
  const double gain_x = xr / total_m2, gain_y = yr / total_m2;
  return {circle.x_m + gain_x * innovation_m,
          circle.y_m + gain_y * innovation_m,
          {xx - gain_x * xr, xy - gain_x * yr, yy - gain_y * yr}};
}

}  // namespace

void place_in_base(Detection& detection, const laser::Segment& segment, const laser::Scan& scan,
                   bool is_trunk, const Rig& rig) {
  const laser::LaserConfig& mount = rig.laser;
  Place place = segment.circle ? by_circle(*segment.circle, is_trunk, rig)
                               : by_range(segment, scan, is_trunk, detection.occlusion != 0, rig);
  // The error common to all beams moves the centre along the line of sight.
  const double shared2 = geometry::square(mount.target_sd_fraction);
  auto& [xx, xy, yy] = place.covariance;
  xx += shared2 * geometry::square(place.x_m);
  xy += shared2 * place.x_m * place.y_m;
  yy += shared2 * geometry::square(place.y_m);

  const double c = std::cos(mount.mount_yaw_rad), s = std::sin(mount.mount_yaw_rad);
  const double laser_x_m = mount.mount_x_m + scan.sway_x_m;
  const double laser_y_m = mount.mount_y_m + scan.sway_y_m;
  detection.surface_x_m =
      laser_x_m + segment.range_m * std::cos(mount.mount_yaw_rad + segment.bearing_rad);
  detection.surface_y_m =
      laser_y_m + segment.range_m * std::sin(mount.mount_yaw_rad + segment.bearing_rad);
  detection.centre_x_m = laser_x_m + c * place.x_m - s * place.y_m;
  detection.centre_y_m = laser_y_m + s * place.x_m + c * place.y_m;
  detection.covariance = geometry::rotated_covariance(place.covariance, mount.mount_yaw_rad);
}

}  // namespace orchard::detection

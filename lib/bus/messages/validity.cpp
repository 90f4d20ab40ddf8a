// SPDX-License-Identifier: BSD-3-Clause
#include "bus/messages/validity.hpp"

#include <cmath>

#include "bus/messages/field_check.hpp"
#include "bus/messages/jpeg_header.hpp"
#include "geometry/angles.hpp"

namespace orchard::bus {
namespace {

/// Default: a message has no consistency checks beyond its field limits.
template <class M>
void check(FieldCheck&, const M&) {}

void check(FieldCheck& c, const laser::Scan& scan) {
  c.require(scan.bearing_step_rad != 0.0, Reason::kOutOfRange, "bearing_step_rad = 0");
  c.require(scan.range_max_m > scan.range_min_m, Reason::kInconsistent,
            "range_max_m is not above range_min_m");
  c.require(!scan.ranges_m.empty(), Reason::kOutOfRange, "num_ranges = 0");
  if (!c.ok()) return;
  const double num_steps = static_cast<double>(scan.ranges_m.size()) - 1.0;
  c.require(num_steps * std::abs(scan.bearing_step_rad) <= 2 * geometry::kPi + 0.1,
            Reason::kInconsistent, "its beams cover more than a full turn");
  c.require(scan.intensities.empty() || scan.intensities.size() == scan.ranges_m.size(),
            Reason::kInconsistent, "num_intensities is neither 0 nor num_ranges");
  // ROS drivers send +inf for no return and NaN or -inf for a failed beam (REP 117); all readers of
  // ranges treat them as no return.
  for (const float range_m : scan.ranges_m) {
    const bool usual = range_m >= 0.0f && range_m <= 1e5f;
    if (!usual && std::isfinite(range_m)) c.field("ranges_m", range_m, 0, 1e5);
  }
  for (const float intensity : scan.intensities) {
    c.require(std::isfinite(intensity), Reason::kNotFinite, "an intensity is not finite");
  }
}

void check(FieldCheck& c, const laser::RearScan& scan) {
  check(c, static_cast<const laser::Scan&>(scan));
}

void check(FieldCheck& c, const vision::Image& image) {
  const std::size_t num_pixels = static_cast<std::size_t>(image.width_px) * image.height_px;
  if (image.encoding == vision::Encoding::kBgr8) {
    c.require(image.data.size() == 3 * num_pixels, Reason::kInconsistent,
              "num_bytes is not 3 x width_px x height_px");
  } else if (image.encoding == vision::Encoding::kGray8) {
    c.require(image.data.size() == num_pixels, Reason::kInconsistent,
              "num_bytes is not width_px x height_px");
  } else {
    const std::optional<JpegSize> size = find_jpeg_size(image.data);
    c.require(size.has_value(), Reason::kInconsistent, "not a JPEG with a frame header");
    c.require(!size || (size->width_px == image.width_px && size->height_px == image.height_px),
              Reason::kInconsistent, "the JPEG's size is not width_px x height_px");
  }
}

void check(FieldCheck& c, const detection::Detections& detections) {
  for (const detection::Detection& trunk : detections.trunks) {
    // single precision: the sum may slightly exceed one
    c.field("probability_tree + probability_object",
            trunk.probability_tree + trunk.probability_object, 0, 1.0001);
    if (!c.ok()) return;
  }
}

void check(FieldCheck& c, const pose::TrajectoryPage& page) {
  // 64-bit, because num_pages of an invalid message may be INT32_MIN.
  c.field("page", page.page, 0, std::int64_t{page.num_pages} - 1);
  std::int64_t before = -1;
  for (const pose::PoseEstimate& pose : page.poses) {
    c.require(pose.utime > before, Reason::kInconsistent, "its poses are not sorted by utime");
    if (!c.ok()) return;
    before = pose.utime;
  }
}

void check(FieldCheck& c, const mapping::MapWays& ways) {
  c.field("part", ways.part, 0, std::int64_t{ways.num_parts} - 1);
  std::int64_t num_points = 0;
  for (const mapping::Way& way : ways.ways) num_points += way.num_points;
  c.require(num_points == static_cast<std::int64_t>(ways.points.size()), Reason::kInconsistent,
            "num_points is not the sum of the ways' points");
}

}  // namespace

std::optional<Rejection> check_consistency(const Message& message) {
  FieldCheck c;
  std::visit([&c](const auto& m) { check(c, m); }, message);
  return std::move(c).result();
}

}  // namespace orchard::bus

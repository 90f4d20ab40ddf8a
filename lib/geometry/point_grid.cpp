// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/point_grid.hpp"

#include <algorithm>
#include <utility>

namespace orchard::geometry {
namespace {

/// Table position of a cell. Four cells of a column share a cache line; the line's index is hashed
/// from all bits of the key, so that the regular rows of an orchard do not cluster in one part of
/// the table.
std::uint64_t spread(std::uint64_t key) {
  std::uint64_t h = (key >> 2) * 0x9E3779B97F4A7C15ull;
  h ^= h >> 32;
  h *= 0xD6E8FEB86659FD93ull;
  h ^= h >> 32;
  return (h << 2) | (key & 3);
}

}  // namespace

std::size_t PointGrid::find(std::uint64_t wanted) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t at = static_cast<std::size_t>(spread(wanted)) & mask;
  while (slots_[at].head != kEmpty && slots_[at].key != wanted) at = (at + 1) & mask;
  return at;
}

void PointGrid::grow() {
  std::vector<Slot> old = std::exchange(slots_, {});
  slots_.resize(old.empty() ? 64 : old.size() * 2);
  num_used_ = 0;
  for (const Slot& slot : old) {
    if (slot.head < 0) continue;
    slots_[find(slot.key)] = slot;
    ++num_used_;
  }
}

void PointGrid::insert(std::int32_t index, double x_m, double y_m) {
  if (slots_.empty() || 10 * (num_used_ + 1) > 7 * slots_.size()) grow();
  const std::size_t i = static_cast<std::size_t>(index);
  if (next_.size() <= i) next_.resize(i + 1, kNone);
  Slot& slot = slots_[find(key(cell(x_m), cell(y_m)))];
  if (slot.head == kEmpty) {
    slot.key = key(cell(x_m), cell(y_m));
    slot.head = kNone;
    ++num_used_;
  }
  next_[i] = slot.head;
  slot.head = index;
}

void PointGrid::remove(std::int32_t index, double x_m, double y_m) {
  if (slots_.empty()) return;
  std::int32_t* link = &slots_[find(key(cell(x_m), cell(y_m)))].head;
  while (*link >= 0 && *link != index) link = &next_[static_cast<std::size_t>(*link)];
  if (*link == index) *link = next_[static_cast<std::size_t>(index)];
}

void PointGrid::move(std::int32_t index, double from_x_m, double from_y_m, double to_x_m,
                     double to_y_m) {
  if (cell(from_x_m) == cell(to_x_m) && cell(from_y_m) == cell(to_y_m)) return;
  remove(index, from_x_m, from_y_m);
  insert(index, to_x_m, to_y_m);
}

void PointGrid::clear() {
  slots_.clear();
  next_.clear();
  num_used_ = 0;
}

std::vector<std::int32_t> PointGrid::near(const Eigen::Vector2d& p, double radius_m) const {
  std::vector<std::int32_t> found;
  near(p.x(), p.y(), radius_m, [&](std::int32_t i) { found.push_back(i); });
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace orchard::geometry

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "device/scanner_session.hpp"
#include "device/velodyne/velodyne_packet.hpp"
#include "laser/layers.hpp"

namespace orchard::device {

/// Where a VLP-16 stands, and at which height its layers are joined.
struct VelodyneMount {
  double scanner_height_m = 0.0;  ///< of its middle above the ground
  double plane_height_m = laser::kTrunkHeight_m;
};

/// A VLP-16, which sends data packets (UDP) to whom its settings name, without a dialogue. Each
/// call of receive() is one datagram.
///
/// A turn begins behind the scanner, opposite to azimuth 0, and becomes one scan, whose beams are
/// the firings: 1808 of 0.199 degrees at 600 rpm. The 16 lasers of a firing fire one after the
/// other and so spread over two thirds of a beam; its bearing is their mean. Packets that overtook
/// each other within a few milliseconds are put in order; of lost ones the beams are "not
/// measured". A turn of which more than half is missing is no scan.
class VelodyneProtocol : public ScannerSession {
 public:
  explicit VelodyneProtocol(const VelodyneMount& mount);

  void connected(std::int64_t host_utime) override;
  void receive(std::string_view bytes, std::int64_t host_utime) override;
  void expire(std::int64_t host_utime) override;
  void host_clock_stepped(std::int64_t step_us) override;
  Condition condition() const override;
  ProtocolCounts counts() const override;

 private:
  struct Held {
    VelodynePacket packet;
    std::int64_t host_utime;
  };
  void refuse(std::string why, std::int64_t host_utime);
  void hold(Held held);
  void take(const Held& held);
  void take_column(const Held& held, std::size_t column);
  void begin_turn(double begin_us, double column_us, const VelodynePacket& packet);
  void add_shots(const VelodynePacket& packet, std::size_t column, double column_us);
  void finish_turn(double end_us, const Held& held);
  void forget_turn();
  std::string note() const override;

  laser::LayerPlan plan_;
  std::vector<std::size_t> lasers_;  ///< those that the plan uses
  std::array<float, VelodynePacket::kNumLasers> level_m_per_unit_{};
  double mean_shot_us_ = 0.0;  ///< after the firing begins, of these lasers
  UnitCounter packets_;
  std::vector<Held> held_;                 ///< in order of time
  std::optional<std::uint32_t> stamp_us_;  ///< of the newest packet taken
  double now_us_ = 0.0;                    ///< its time; only differences are used
  std::optional<double> turned_cdeg_;      ///< of the column before, from behind the scanner
  std::optional<laser::JoinedTurn> turn_;  ///< none before the first begin of one
  double begin_us_ = 0.0;                  ///< when it looked straight behind
  double first_us_ = 0.0;                  ///< its first firing
  std::size_t num_columns_ = 0;            ///< that came of it
  double sum_beams_ = 0.0, sum_turned_cdeg_ = 0.0;  ///< over its columns
  double rate_rpm_ = 0.0;                           ///< of the last turn
  VelodynePacket::Returns returns_ = VelodynePacket::Returns::kStrongest;
};

}  // namespace orchard::device

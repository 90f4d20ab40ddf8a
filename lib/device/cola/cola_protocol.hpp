// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "device/scanner_session.hpp"
#include "laser/scan.hpp"

namespace orchard::device {

/// Reads the fields of a CoLa-A telegram in sequence; single blanks separate them. After the first
/// missing or malformed field, ok() is false and nothing more is read.
class ColaFields {
 public:
  explicit ColaFields(std::string_view telegram) : rest_(telegram) {}

  bool ok() const { return ok_; }

  /// The next field as text; empty after the last.
  std::string_view text();

  /// Reads an unsigned number of up to eight hexadecimal digits, not above `max`.
  std::uint32_t number(std::uint32_t max = 0xffffffffu);

  /// Reads a signed 32-bit number: hexadecimal two's complement, or decimal after + or -.
  std::int32_t signed_number();

  /// Reads an IEEE 754 number in hexadecimal digits ("3F800000" is 1).
  float real();

  void skip(int num_fields);

 private:
  std::string_view rest_;
  bool ok_ = true;
};

/// Range limits and start angle of a family of scanners, found by the device's own name.
struct ColaModel {
  double range_min_m = 0.01;
  double range_max_m = 65.0;
  /// Angle at which a full sweep begins [1/10000 degree]: the device's time stamp is of this
  /// instant.
  std::int32_t stamped_angle = -450000;
};

/// The model for the name in a reply to DeviceIdent ("TiM561-2050101"); unknown names get the
/// widest limits.
ColaModel cola_model(std::string_view name);

/// Output angles reported by the device (LMPoutputRange) [1/10000 degree].
struct ColaRange {
  std::int32_t start = 0;
  std::int32_t stop = 0;
};

std::optional<ColaRange> parse_cola_range(std::string_view telegram);

/// The content of one LMDscandata telegram.
struct ColaScan {
  std::uint32_t num_sent = 0;     ///< telegram counter, 16 bits
  std::uint32_t start_ticks = 0;  ///< us since power-up, 32 bits: start of the full sweep
  std::uint32_t sent_ticks = 0;   ///< same clock: transmission of the telegram
  double to_first_beam_us = 0.0;  ///< time from start_ticks to the first beam
  bool has_error = false;         ///< device status: measurement error
  bool is_dirty = false;          ///< device status: front screen is dirty
  laser::Scan scan;               ///< without utime and seq
};

/// Parses a telegram "sSN LMDscandata ..." (SICK telegram listing 8014631). None when it is
/// incomplete, a number is malformed, or angles, counts or rates are implausible.
///
/// Device angles count from the right, so that 90 degrees is straight ahead. The angular step is
/// rounded to 1/10000 degree; where `range` gives the same ends, the step is computed from the ends
/// instead. RSSI1 gives the intensities when the telegram has it.
std::optional<ColaScan> parse_cola_scan(std::string_view telegram, const ColaModel& model,
                                        const std::optional<ColaRange>& range);

/// CoLa-A protocol of SICK scanners TiM3xx, TiM5xx and LMS1xx (telegram listing 8014631). Stops the
/// scanner, identifies it, enables intensities where permitted, and subscribes to every sweep.
///
/// CoLa-A has no checksum: TCP protects the bytes, and every field of a telegram is validated.
class ColaProtocol : public ScannerSession {
 public:
  ColaProtocol();

  void connected(std::int64_t host_utime) override;
  void receive(std::string_view bytes, std::int64_t host_utime) override;
  void expire(std::int64_t host_utime) override;

 private:
  /// The dialogue in order. The device may refuse any step from kIdentify to kRun.
  enum class Step { kStop, kIdentify, kRange, kLogin, kConfigure, kRun, kStart, kStream };

  void ask(Step step, std::int64_t host_utime);
  void ask_again(std::int64_t host_utime);
  void go_on(bool was_granted, std::int64_t host_utime);
  void take(std::string_view telegram, std::int64_t host_utime);
  void take_sweep(std::string_view telegram, std::int64_t host_utime);

  Step step_ = Step::kStop;
  ColaModel model_;
  std::optional<ColaRange> range_;
};

}  // namespace orchard::device

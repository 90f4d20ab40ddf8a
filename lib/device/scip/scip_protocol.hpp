// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "device/scanner_session.hpp"
#include "geometry/angles.hpp"
#include "laser/scan.hpp"

namespace orchard::device {

/// Checksum of a line: the lower six bits of the sum of its characters, plus 30h (SCIP 2.0, 7).
char scip_sum(std::string_view text);

/// The line without the checksum at its end; none when the checksum is wrong.
std::optional<std::string_view> checked_line(std::string_view line);

/// The same for the lines of PP, VV and II such as "AMIN:44;7"; the checksum leaves out the
/// semicolon.
std::optional<std::string_view> checked_parameter(std::string_view line);

/// Decodes a number of up to five characters of six bits each, 30h for 0 (SCIP 2.0, 6); none when a
/// character is outside 30h to 6fh.
std::optional<std::uint32_t> scip_number(std::string_view characters);

/// The scanner's reply to one command, or one sweep.
struct ScipReply {
  std::string_view echo;               ///< the command as received
  std::string_view status;             ///< two characters, checked
  std::vector<std::string_view> body;  ///< lines with their checksums, not verified yet
};

/// Parses a reply from its echo up to the empty line that ends it. None when it has no echo, or its
/// status is not two characters and their checksum.
std::optional<ScipReply> parse_scip_reply(std::string_view text);

/// Parameters of a scanner (reply to PP), which determine its angles, ranges and times.
struct ScipParameters {
  std::string model;       ///< MODL, verbatim
  int range_min_mm = 0;    ///< DMIN: values below are error codes
  int range_max_mm = 0;    ///< DMAX
  int steps_per_turn = 0;  ///< ARES
  int first_step = 0;      ///< AMIN
  int last_step = 0;       ///< AMAX
  int front_step = 0;      ///< AFRT: straight ahead
  double rate_rpm = 0.0;   ///< SCAN, or the motor speed reported by II

  int num_beams() const { return last_step - first_step + 1; }

  /// Angle of one step; steps count counter-clockwise, seen from above.
  double step_rad() const { return 2.0 * geometry::kPi / steps_per_turn; }
  double bearing_min_rad() const { return (first_step - front_step) * step_rad(); }
  double turn_us() const { return 60e6 / rate_rpm; }
  double beam_period_us() const { return turn_us() / steps_per_turn; }

  /// Ranges up to 4095 mm fit two characters, larger ones need three.
  bool fits_two_characters() const { return range_max_mm <= 4095; }
};

/// Parses the lines of a reply to PP. None when a number is missing, a checksum is wrong, or the
/// values together are implausible.
std::optional<ScipParameters> parse_scip_parameters(const std::vector<std::string_view>& lines);

/// Parses the motor speed [rpm] from the lines of a reply to II ("SCSP:Initial(600[rpm])"); none
/// when absent.
std::optional<double> parse_scip_motor_rpm(const std::vector<std::string_view>& lines);

/// Encoding of a beam.
enum class ScipEncoding {
  kTwo,                 ///< MS: a range in two characters
  kThree,               ///< MD: a range in three characters
  kThreeWithIntensity,  ///< ME: a range and an intensity in three each
};

int characters_per_beam(ScipEncoding encoding);

/// One sweep of the scanner.
struct ScipSweep {
  std::uint32_t ticks = 0;  ///< 24 bits of milliseconds; the motor passed step 0
  laser::Scan scan;         ///< without utime and seq
};

/// Parses the lines after the status "99": time and ranges. None when a checksum is wrong or the
/// number of characters does not match the number of beams.
///
/// Values outside DMIN to DMAX are error codes or out of reach: no return.
std::optional<ScipSweep> parse_scip_sweep(const std::vector<std::string_view>& lines,
                                          const ScipParameters& parameters, ScipEncoding encoding);

/// SCIP protocol, 2.0 or later, of Hokuyo scanners URG-04LX-UG01, UTM-30LX, UST-10LX and similar
/// (specification C-42-03320B). Stops the scanner, reads its parameters and its clock, and requests
/// every sweep, with intensities where the model has them.
class ScipProtocol : public ScannerSession {
 public:
  ScipProtocol();

  void connected(std::int64_t host_utime) override;
  void receive(std::string_view bytes, std::int64_t host_utime) override;
  void expire(std::int64_t host_utime) override;

 private:
  /// The dialogue in order.
  enum class Step { kStop, kParameters, kState, kClockIn, kClockRead, kClockOut, kLaser, kStream };

  void ask(Step step, std::int64_t host_utime);
  void ask_again(std::int64_t host_utime);
  ScipEncoding best_encoding() const;
  void begin_stream(ScipEncoding encoding, std::int64_t host_utime);
  void take(const ScipReply& reply, std::int64_t host_utime);
  void take_parameters(const ScipReply& reply, std::int64_t host_utime);
  void take_clock_reading(const ScipReply& reply, std::int64_t host_utime);
  void take_stream(const ScipReply& reply, std::int64_t host_utime);
  void take_sweep(const ScipReply& reply, std::int64_t host_utime);
  void refuse_stream(std::string_view status, std::int64_t host_utime);
  void grant();
  void ask_for_stream_again(std::int64_t host_utime);
  std::string no_answer() const;
  std::size_t last_echo(std::string_view text) const;
  bool is_answer(std::string_view echo) const;

  Step step_ = Step::kStop;
  int num_readings_ = 0;
  std::optional<ScipParameters> parameters_;
  ScipEncoding encoding_ = ScipEncoding::kThree;
  bool is_granted_ = false;  ///< the scanner has accepted the request for sweeps
  bool is_refused_ = false;  ///< it has refused it, and may not do so later
};

}  // namespace orchard::device

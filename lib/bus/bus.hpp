// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "bus/messages/codec.hpp"
#include "bus/messages/service_messages.hpp"

namespace orchard::bus {

/// Thrown when the LCM network cannot be used with the given URL. The message says why and what to
/// do.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The raw bytes of a received message; valid only while the handler runs.
struct Bytes {
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
};

/// Counters of received, rejected and sent messages.
struct BusCounts {
  std::int64_t num_good = 0;
  std::int64_t num_published = 0;
  std::int64_t num_unsent = 0;  ///< rejected by the network when sending
  std::array<std::int64_t, kNumReasons> num_rejected{};
  std::int64_t num_bad() const;
};

/// One LCM instance with validation: every received message is decoded and checked before a handler
/// sees it. Rejected messages are counted by reason and logged at a limited rate.
///
/// Single-threaded. Handlers may publish and may throw; handle() rethrows the exception after LCM's
/// C frames have returned.
class Bus {
 public:
  /// Opens a "udpm://..." or "memq://" URL. With its parameter `robot=NAME` (network.hpp) every
  /// channel is NAME/CHANNEL on the wire, so that several robots can share a network. Throws
  /// BusError with a hint.
  explicit Bus(const std::string& url);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  /// Maximum queue length of a subscription [messages]; LCM drops messages beyond it.
  static constexpr int kLargeQueue = 20000;  ///< for a recorder
  static constexpr int kInputQueue = 2000;
  static constexpr int kImageQueue = 64;

  /// Subscribes a handler to a channel. Several handlers of one channel run in the order of
  /// subscription, each with a message of its own. Throws BusError when nothing can be received
  /// (LCM's self test failed).
  void subscribe(Channel channel, std::function<void(Message&&, Bytes)> handler);
  void subscribe_status(std::function<void(const Status&)> handler);
  void subscribe_config(std::function<void(const ConfigNotice&)> handler);
  void subscribe_ack(std::function<void(const Ack&)> handler);
  void subscribe_replay(std::function<void(const ReplayMark&)> handler);

  /// Subscribes to every message of every channel, known or unknown, without decoding or checks.
  /// On a URL with a robot: its channels, by their names without it, and unknown ones, but not the
  /// known ones of others. For recorders only; must be the first subscription (BusError otherwise).
  /// `receipt_utime`: host time of day at which LCM received the message [us].
  void subscribe_raw(
      std::function<void(const std::string& channel, std::int64_t receipt_utime, Bytes)> handler);

  /// Sets a handler that is called for each rejected message, in addition to counting and logging.
  /// The handler may throw.
  void on_rejection(std::function<void(Channel, const Rejection&)> handler);

  /// Sends a message. Returns false, and counts it in num_unsent, when the network rejects it.
  bool publish(Channel channel, const std::vector<std::uint8_t>& bytes);
  bool publish(const Message& message);

  /// File descriptor that becomes readable when a message is waiting.
  int fileno() const;

  /// Handles one message, waiting at most `timeout_ms` for it. Returns false when none arrived or a
  /// signal interrupted the wait. Throws BusError and whatever a handler threw.
  bool handle(int timeout_ms);

  const BusCounts& counts() const;
  /// Number of datagrams that the kernel dropped: crafted ones (SocketGuard) or receive buffer
  /// overflow. Only known after subscribe_raw(); otherwise 0, because the kernel's counter would
  /// include the channels that are filtered out on purpose.
  std::int64_t num_dropped() const;
  const std::string& url() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace orchard::bus

// SPDX-License-Identifier: BSD-3-Clause
#include "bus/bot_core/bot_core_driver.hpp"

#include <lcm/lcm.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <exception>
#include <utility>
#include <vector>

#include "bus/bus.hpp"
#include "bus/socket_guard.hpp"

namespace orchard::bus {
namespace {

constexpr int kQueue = 500;      // LCM drops messages beyond it
constexpr int kMaxAtOnce = 200;  // then STATUS and a stop are checked
constexpr auto kSilence = std::chrono::seconds(1);

}  // namespace

struct BotCoreDriver::Inbox {
  SocketGuard guard;  // constructed before LCM opens its sockets
  lcm_t* lcm = nullptr;
  BotCoreTranslator* translator = nullptr;
  std::vector<Message> messages;
  std::exception_ptr pending;

  ~Inbox() {
    if (lcm != nullptr) lcm_destroy(lcm);
  }

  /// LCM's C frames are on the stack: no exception may leave this function.
  static void on_message(const lcm_recv_buf_t* buffer, const char* channel, void* context) {
    auto* inbox = static_cast<Inbox*>(context);
    try {
      auto message = inbox->translator->translate(channel, buffer->data, buffer->data_size);
      if (message) inbox->messages.push_back(*std::move(message));
    } catch (...) {
      inbox->pending = std::current_exception();
    }
  }
};

BotCoreDriver::BotCoreDriver(const device::BotCoreConfig& config, std::size_t max_image_bytes)
    : inbox_(std::make_unique<Inbox>()),
      translator_(config, max_image_bytes),
      lcm_url_(config.lcm_url),
      heard_(Clock::now()) {
  inbox_->translator = &translator_;
  inbox_->lcm = lcm_create(lcm_url_.c_str());
  if (inbox_->lcm == nullptr) {
    throw BusError(
        "LCM cannot use drivers.bot_core.lcm_url " + lcm_url_ +
        ": check its address and port, and the multicast route (`orchard doctor` tests it)");
  }
  lcm_subscription_t* subscription =
      lcm_subscribe(inbox_->lcm, ".*", &Inbox::on_message, inbox_.get());
  if (subscription == nullptr) throw BusError("cannot subscribe to messages on " + lcm_url_);
  lcm_subscription_set_queue_capacity(subscription, kQueue);
  const bool is_network = lcm_url_.compare(0, 7, "udpm://") == 0;
  if (is_network && inbox_->guard.attach() == 0) {
    spdlog::warn(
        "the socket of {} has no filter: malformed datagrams can crash this process (see "
        "SECURITY.md)",
        lcm_url_);
  }
}

BotCoreDriver::~BotCoreDriver() = default;

std::vector<pollfd> BotCoreDriver::files() { return {{lcm_get_fileno(inbox_->lcm), POLLIN, 0}}; }

Driver::Clock::time_point BotCoreDriver::deadline() { return Clock::time_point::max(); }

void BotCoreDriver::step(const Outbox& send) {
  for (int i = 0; i < kMaxAtOnce; ++i) {
    if (lcm_handle_timeout(inbox_->lcm, 0) <= 0) break;
    if (inbox_->pending) std::rethrow_exception(std::exchange(inbox_->pending, nullptr));
  }
  for (Message& message : inbox_->messages) {
    heard_ = Clock::now();
    has_heard_ = true;
    send(std::move(message));
  }
  inbox_->messages.clear();
}

DriverCondition BotCoreDriver::condition() const {
  DriverCondition condition;
  condition.num_bad = translator_.num_bad();
  if (!has_heard_) {
    condition.level = Level::kWaiting;
    condition.text = "waits for planar_lidar_t, image_t, pose_t or gps_data_t on " + lcm_url_;
  } else if (Clock::now() - heard_ > kSilence) {
    condition.level = Level::kError;
    condition.text = "no message of libbot's types for more than a second on " + lcm_url_;
  }
  return condition;
}

}  // namespace orchard::bus

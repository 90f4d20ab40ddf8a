// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/logs.hpp"

#include <fmt/core.h>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <string>

#include "bus/bus.hpp"
#include "bus/messages/fields.hpp"
#include "bus/messages/message.hpp"
#include "bus/messages/service_messages.hpp"
#include "bus/node/stop_signal.hpp"
#include "bus/process/process.hpp"
#include "cli/field/field.hpp"

namespace orchard::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kWordsOfArray = 8;

std::string text_of(detection::Label label) {
  constexpr const char* kNames[] = {"unseen", "tree", "object"};
  return kNames[static_cast<int>(label)];
}
std::string text_of(vision::Encoding encoding) {
  constexpr const char* kNames[] = {"JPEG", "BGR8", "GRAY8"};
  return kNames[static_cast<int>(encoding)];
}
std::string text_of(mapping::EdgeKind kind) {
  return kind == mapping::EdgeKind::kAisle ? "aisle" : "headland";
}

std::string text_of(bus::Level level) {
  constexpr const char* kNames[] = {"ok", "waiting", "warning", "error"};
  return kNames[static_cast<int>(level)];
}
std::string text_of(bus::Channel channel) { return std::string(bus::info(channel).name); }

/// Visitor that writes a message's fields to JSON; see bus/messages/fields.hpp.
class FieldsAsJson {
 public:
  void stamp(std::int64_t utime, std::int32_t seq) {
    put("utime", utime);
    put("seq", seq);
  }
  void time(const char* name, std::int64_t utime) { put(name, utime); }
  template <class T, class Lo, class Hi>
  void field(const char* name, const T& value, Lo, Hi) {
    put(name, value);
  }
  template <std::size_t N>
  void covariance(const char* name, const std::array<double, N>& values) {
    put(name, values);
  }
  template <class T>
  void count(const char* name, const std::vector<T>& values) {
    put(name, values.size());
  }
  template <class T, class... Limits>
  void array(const char* name, const std::vector<T>& values, const char*, Limits...) {
    put(name, values);
  }
  void array(const char*, const std::vector<std::uint8_t>&, const char*) {}  // a picture
  template <class T, class Fields>
  void items(const char* name, const std::vector<T>& values, const char*, Fields) {
    json_[name] = Json::array();
    for (const T& value : values) {
      FieldsAsJson nested;
      Fields::visit(value, nested);
      json_[name].push_back(std::move(nested.json_));
    }
  }
  template <class T, class Member, class Lo, class Hi>
  void column(const char* name, const std::vector<T>& values, const char*, Member T::*member, Lo,
              Hi) {
    json_[name] = Json::array();
    for (const T& value : values) json_[name].push_back(json_of(value.*member));
  }
  void text(const char* name, const std::string& value) { put(name, value); }

  const Json& json() const { return json_; }

 private:
  template <class T>
  static Json json_of(const T& value) {
    if constexpr (std::is_enum_v<T>) {
      return text_of(value);
    } else {
      return value;
    }
  }
  template <class T>
  void put(const char* name, const T& value) {
    json_[name] = json_of(value);
  }
  Json json_;
};

/// Formats a value as text: numbers short, arrays truncated, objects in braces.
std::string words(const Json& value) {
  if (value.is_number_float()) {
    return fmt::format("{:.6g}", value.get<double>());
  }
  if (value.is_object()) {
    std::string text;
    for (const auto& [key, field] : value.items()) {
      text += (text.empty() ? "" : " ") + key + "=" + words(field);
    }
    return "{" + text + "}";
  }
  if (!value.is_array()) return value.dump();
  std::string text;
  for (std::size_t i = 0; i < value.size() && i < kWordsOfArray; ++i) {
    text += (i == 0 ? "" : " ") + words(value[i]);
  }
  if (value.size() > kWordsOfArray) text += " ... " + std::to_string(value.size()) + " values";
  return "[" + text + "]";
}

std::string line(const Json& all, bool json) {
  // Strings from the network may be invalid UTF-8 or contain terminal escape codes; ASCII output
  // avoids both.
  if (json) return all.dump(-1, ' ', true, Json::error_handler_t::replace);
  std::string text;
  for (const auto& [key, field] : all.items()) {
    const bool is_text = field.is_string();
    text += (text.empty() ? "" : " ") + key + "=" +
            (is_text ? field.dump(-1, ' ', true, Json::error_handler_t::replace) : words(field));
  }
  return text;
}

template <class M>
std::string message_text(const M& message, bool json) {
  FieldsAsJson fields;
  bus::visit_fields(message, fields);
  return line(fields.json(), json);
}

std::string message_text(const bus::Message& message, bool json) {
  return std::visit([json](const auto& m) { return message_text(m, json); }, message);
}

using bus::Channel;

std::string channel_names() {
  std::string names;
  for (const bus::ChannelInfo& channel : bus::kChannels) {
    names += (names.empty() ? "" : ", ") + std::string(channel.name);
  }
  return names;
}

void echo(Channel channel, const EchoOptions& options, const std::string& lcm_url) {
  bus::StopSignal stop;
  bus::Bus bus(lcm_url);
  std::int64_t num_printed = 0;
  const auto print = [&](const auto& message) {
    std::printf("%s\n", message_text(message, options.json).c_str());
    std::fflush(stdout);
    ++num_printed;
  };
  switch (channel) {
    case Channel::kStatus:
      bus.subscribe_status(print);
      break;
    case Channel::kConfig:
      bus.subscribe_config(print);
      break;
    case Channel::kAck:
      bus.subscribe_ack(print);
      break;
    case Channel::kReplay:
      bus.subscribe_replay(print);
      break;
    default:
      bus.subscribe(channel, [&](const bus::Message& m, bus::Bytes) { print(m); });
  }
  while (!stop.raised() && (options.count == 0 || num_printed < options.count)) {
    if (stop.wait(bus.fileno(), 5000)) {
      bus.handle(0);
    } else if (num_printed == 0 && !stop.raised()) {
      std::fprintf(stderr, "orchard echo: no message on %s yet; LCM network: %s\n",
                   std::string(bus::info(channel).name).c_str(), lcm_url.c_str());
    }
  }
}

}  // namespace

int run_echo(const EchoOptions& options) {
  const auto channel = bus::find_channel(options.channel);
  if (!channel) {
    std::fprintf(stderr, "orchard echo: unknown channel \"%s\"; choose one of %s\n",
                 options.channel.c_str(), channel_names().c_str());
    return bus::kExitUsage;
  }
  try {
    echo(*channel, options, field_url(options));
    return bus::kExitOk;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "orchard echo: %s\n", error.what());
    return bus::kExitRuntime;
  }
}

}  // namespace orchard::cli

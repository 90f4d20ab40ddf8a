// SPDX-License-Identifier: BSD-3-Clause
#include "cli/rig/network_facts.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

namespace orchard::cli {
namespace {

template <class Number>
bool read_number(std::string_view text, Number& value) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc() && result.ptr == text.data() + text.size();
}

bool read_option(std::string_view option, UdpmUrl& url) {
  const std::size_t equals = option.find('=');
  if (equals == std::string_view::npos) return false;
  const std::string_view key = option.substr(0, equals);
  const std::string_view value = option.substr(equals + 1);
  if (key == "ttl") return read_number(value, url.ttl);
  if (key == "recv_buf_size") return read_number(value, url.recv_buf_size);
  return true;
}

}  // namespace

std::optional<UdpmUrl> parse_udpm_url(const std::string& text) {
  constexpr std::string_view kScheme = "udpm://";
  std::string_view rest = text;
  if (rest.substr(0, kScheme.size()) != kScheme) return std::nullopt;
  rest.remove_prefix(kScheme.size());
  UdpmUrl url;
  const std::size_t question = rest.find('?');
  std::string_view network = rest.substr(0, question);
  std::string_view options =
      question == std::string_view::npos ? std::string_view() : rest.substr(question + 1);
  const std::size_t colon = network.find(':');
  if (colon != std::string_view::npos && !read_number(network.substr(colon + 1), url.port)) {
    return std::nullopt;
  }
  network = network.substr(0, colon);
  if (!network.empty()) url.address = std::string(network);
  while (!options.empty()) {
    const std::size_t end = std::min(options.find_first_of("&;"), options.size());
    if (!read_option(options.substr(0, end), url)) return std::nullopt;
    options.remove_prefix(std::min(end + 1, options.size()));
  }
  in_addr address{};
  if (inet_pton(AF_INET, url.address.c_str(), &address) != 1) return std::nullopt;
  if (!IN_MULTICAST(ntohl(address.s_addr)) || url.port < 1 || url.port > 65535) return std::nullopt;
  return url;
}

std::vector<NetworkInterface> network_interfaces() {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return {};
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner(list, freeifaddrs);
  std::vector<NetworkInterface> interfaces;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    auto known = std::find_if(interfaces.begin(), interfaces.end(),
                              [&](const NetworkInterface& i) { return i.name == entry->ifa_name; });
    if (known == interfaces.end()) {
      NetworkInterface interface;
      interface.name = entry->ifa_name;
      known = interfaces.insert(interfaces.end(), interface);
    }
    known->up = (entry->ifa_flags & IFF_UP) != 0;
    known->loopback = (entry->ifa_flags & IFF_LOOPBACK) != 0;
    known->multicast = (entry->ifa_flags & IFF_MULTICAST) != 0;
    if (entry->ifa_addr != nullptr && entry->ifa_addr->sa_family == AF_INET) known->has_ipv4 = true;
  }
  return interfaces;
}

std::optional<std::string> route_to(const std::string& address) {
  in_addr parsed{};
  if (inet_pton(AF_INET, address.c_str(), &parsed) != 1) return std::nullopt;
  const std::string command = "ip -j route get " + address + " 2>/dev/null";
  const std::unique_ptr<FILE, int (*)(FILE*)> output(popen(command.c_str(), "re"), pclose);
  std::string text;
  for (int c = 0; output && (c = std::fgetc(output.get())) != EOF;) text += static_cast<char>(c);
  const auto routes = nlohmann::json::parse(text, nullptr, false);
  if (!routes.is_array() || routes.empty() || !routes[0].is_object()) return std::nullopt;
  const auto device = routes[0].find("dev");
  if (device == routes[0].end() || !device->is_string()) return std::nullopt;
  return device->get<std::string>();
}

std::optional<std::int64_t> kernel_setting(const std::string& name) {
  std::ifstream file("/proc/sys/" + name);
  std::int64_t value = 0;
  if (!(file >> value)) return std::nullopt;
  return value;
}

std::optional<bool> runts_arrive(const UdpmUrl& url) {
  const auto close_it = [](const int* fd) { close(*fd); };
  const int listener = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int sender = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const std::unique_ptr<const int, decltype(close_it)> a(&listener, close_it);
  const std::unique_ptr<const int, decltype(close_it)> b(&sender, close_it);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(url.port));
  ip_mreq group{};
  if (inet_pton(AF_INET, url.address.c_str(), &group.imr_multiaddr) != 1) return std::nullopt;
  const int yes = 1;
  setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  setsockopt(listener, SOL_SOCKET, SO_REUSEPORT, &yes, sizeof(yes));
  const timeval patience{0, 200000};
  setsockopt(listener, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  if (bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0 ||
      setsockopt(listener, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof(group)) != 0) {
    return std::nullopt;
  }
  address.sin_addr = group.imr_multiaddr;
  const unsigned char ttl = 0;
  setsockopt(sender, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof(ttl));
  // Shorter than LCM's header: every LCM program ignores it.
  const char runt[5] = {'L', 'C', '0', '2', 0};
  if (sendto(sender, runt, sizeof(runt), 0, reinterpret_cast<const sockaddr*>(&address),
             sizeof(address)) != static_cast<ssize_t>(sizeof(runt))) {
    return std::nullopt;
  }
  char bytes[65536];
  for (int i = 0; i < 200; ++i) {  // among datagrams of other senders
    const ssize_t size = recv(listener, bytes, sizeof(bytes), 0);
    if (size < 0) return false;
    if (size == static_cast<ssize_t>(sizeof(runt))) return true;
  }
  return std::nullopt;
}

int num_sockets_on_port(int port) {
  std::ifstream file("/proc/net/udp");
  std::string line;
  std::getline(file, line);  // headings
  int count = 0;
  while (std::getline(file, line)) {
    // "sl  local_address rem_address ...": local_address is ADDRESS:PORT in hexadecimal
    std::istringstream words(line);
    std::string slot;
    std::string local;
    words >> slot >> local;
    const std::size_t colon = local.find(':');
    if (colon == std::string::npos) continue;
    int local_port = 0;
    const std::string hex = local.substr(colon + 1);
    std::from_chars(hex.data(), hex.data() + hex.size(), local_port, 16);
    count += local_port == port ? 1 : 0;
  }
  return count;
}

}  // namespace orchard::cli

// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/page_server.hpp"

namespace orchard::procs {

bool is_loopback(const std::string& address) {
  return address.rfind("127.", 0) == 0 || address == "::1" || address == "localhost";
}

bool is_own_host(const std::string& host, const std::string& address, int port) {
  const std::string at_port = ":" + std::to_string(port);
  for (const std::string& name :
       {std::string("localhost"), std::string("127.0.0.1"), std::string("[::1]"), address}) {
    if (host == name + at_port || host == name) return true;
  }
  return false;
}

bool is_same_secret(const std::string& a, const std::string& b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const char other = b.empty() ? '\0' : b[k % b.size()];
    difference |= static_cast<unsigned char>(a[k]) ^ static_cast<unsigned char>(other);
  }
  return difference == 0;
}

}  // namespace orchard::procs

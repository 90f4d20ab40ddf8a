// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/page_server.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

namespace orchard::procs {
namespace {

class OnePage final : public PageContent {
 public:
  std::string page() const override { return "the page"; }
  std::vector<std::string> events_for(view::ViewerProgress&, bool&) const override { return {}; }
  std::optional<PageAnswer> get(const std::string&, const Parameters&) override { return {}; }
  PageAnswer edit(const std::string&) override { return {}; }
};

/// A server on a free port of this machine, and requests in their bytes.
class PageServerTest : public ::testing::Test {
 protected:
  void serve(const std::string& token) {
    PageServerOptions options;
    options.token = token;
    options.port = 18420;
    server_.emplace(content_, options);
    const std::string& url = server_->url();
    port_ = std::atoi(url.c_str() + url.rfind(':') + 1);
  }

  /// What the server answers, to its end; a connection that it resets ends as well.
  std::string answer_to(const std::string& request) const {
    const int wire = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port_));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(wire, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    for (std::size_t at = 0; at < request.size();) {
      const ssize_t count = ::send(wire, request.data() + at, request.size() - at, MSG_NOSIGNAL);
      if (count <= 0) break;
      at += static_cast<std::size_t>(count);
    }
    std::string answer;
    char bytes[4096];
    for (ssize_t count = 0; (count = ::recv(wire, bytes, sizeof(bytes), 0)) > 0;) {
      answer.append(bytes, static_cast<std::size_t>(count));
    }
    ::close(wire);
    return answer;
  }

  /// The status of a request with these header lines, Host among them.
  std::string status_with(const std::string& headers) const {
    const std::string answer = answer_to("GET / HTTP/1.1\r\n" + headers + "\r\n");
    return answer.substr(0, answer.find("\r\n"));
  }
  std::string host() const { return "Host: 127.0.0.1:" + std::to_string(port_) + "\r\n"; }

  static constexpr const char* kOk = "HTTP/1.1 200 OK";
  static constexpr const char* kForbidden = "HTTP/1.1 403 Forbidden";
  int port_ = 0;

 private:
  OnePage content_;
  std::optional<PageServer> server_;
};

TEST_F(PageServerTest, TheTokenIsACookieOfItsOwnName) {
  serve("secret");
  EXPECT_EQ(status_with(host() + "Cookie: orchard_token=secret\r\n"), kOk);
  EXPECT_EQ(status_with(host() + "Cookie: a=b; orchard_token=secret; c=d\r\n"), kOk);
  // RFC 6265, 4.1: a name is all that stands before the =
  EXPECT_EQ(status_with(host() + "Cookie: not_orchard_token=secret\r\n"), kForbidden);
  EXPECT_EQ(status_with(host() + "Cookie: a=orchard_token=secret\r\n"), kForbidden);
  EXPECT_EQ(status_with(host() + "Cookie: x_orchard_token=old; orchard_token=secret\r\n"), kOk);
  EXPECT_EQ(status_with(host() + "Cookie: orchard_token=secre\r\n"), kForbidden);
  EXPECT_EQ(status_with(host()), kForbidden);
}

TEST_F(PageServerTest, HostsAreComparedWithoutCase) {
  serve("");
  const std::string port = ":" + std::to_string(port_) + "\r\n";
  EXPECT_EQ(status_with("Host: localhost" + port), kOk);
  EXPECT_EQ(status_with("Host: LocalHost" + port), kOk);
  EXPECT_EQ(status_with("Host: LOCALHOST.evil.example" + port), kForbidden);
}

TEST_F(PageServerTest, HeadersWithoutEndAreNotRead) {
  serve("");
  std::string some, many;
  for (int k = 0; k < 100; ++k) some += "X-" + std::to_string(k) + ": y\r\n";
  for (int k = 0; k < 100000; ++k) many += "X-" + std::to_string(k) + ": y\r\n";
  EXPECT_EQ(status_with(host() + some), kOk);
  EXPECT_NE(status_with(host() + many), kOk);
  EXPECT_EQ(status_with(host()), kOk);  // and it serves on
}

}  // namespace
}  // namespace orchard::procs

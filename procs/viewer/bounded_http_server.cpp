// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/bounded_http_server.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>

namespace orchard::procs {
namespace {

constexpr int kSilence_ms = 3000;  ///< after which a peer is given up

bool is_ready(int socket, short event, int timeout_ms) {
  pollfd wanted{socket, event, 0};
  int result = 0;
  while ((result = ::poll(&wanted, 1, timeout_ms)) < 0 && errno == EINTR) {
  }
  return result > 0 && (wanted.revents & event) != 0;
}

/// A connection that ends for its reader after some bytes.
class BoundedStream final : public httplib::Stream {
 public:
  BoundedStream(int socket, std::size_t bytes_max) : socket_(socket), left_(bytes_max) {}

  bool is_readable() const override { return is_ready(socket_, POLLIN, kSilence_ms); }
  bool is_writable() const override {
    char byte = 0;
    const bool is_closed = ::recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
    return !is_closed && is_ready(socket_, POLLOUT, kSilence_ms);
  }
  ssize_t read(char* bytes, std::size_t size) override {
    if (left_ == 0 || !is_readable()) return -1;
    ssize_t count = 0;
    while ((count = ::recv(socket_, bytes, std::min(size, left_), 0)) < 0 && errno == EINTR) {
    }
    if (count > 0) left_ -= static_cast<std::size_t>(count);
    return count;
  }
  ssize_t write(const char* bytes, std::size_t size) override {
    if (!is_ready(socket_, POLLOUT, kSilence_ms)) return -1;
    ssize_t count = 0;
    while ((count = ::send(socket_, bytes, size, MSG_NOSIGNAL)) < 0 && errno == EINTR) {
    }
    return count;
  }
  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return socket_; }

 private:
  int socket_;
  std::size_t left_;
};

}  // namespace

bool BoundedHttpServer::process_and_close_socket(socket_t socket) {
  BoundedStream stream(socket, request_bytes_max_);
  bool is_closed = false;
  const bool is_answered = process_request(stream, true, is_closed, nullptr);
  ::shutdown(socket, SHUT_RDWR);
  ::close(socket);
  return is_answered;
}

}  // namespace orchard::procs

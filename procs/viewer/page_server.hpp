// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "viewer/page_content.hpp"

namespace orchard::procs {

/// Address and access control of a page server.
struct PageServerOptions {
  std::string address = "127.0.0.1";
  int port = 8420;
  bool may_move = true;  ///< use one of the next ports when this one is taken
  std::string token;     ///< required from clients on other hosts; empty: no other host has access
};

/// Serves a page and its events over HTTP, in its own threads.
///
/// `/` is the page, `/api/stream` the server-sent events, `/api/NAME` the content's answer, else
/// 404. All methods other than GET give 405, except POST to `/api/edit` from the server's own page
/// where the content can be edited.
class PageServer {
 public:
  /// Max number of concurrent streams, each of which holds a thread; a further one gets status 503.
  static constexpr int kStreamsMax = 32;

  /// Throws std::runtime_error when the address is not available, or is not a loopback address and
  /// there is no token. `content` must outlive this.
  PageServer(PageContent& content, const PageServerOptions& options);
  ~PageServer();

  /// "http://127.0.0.1:8420/"
  const std::string& url() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// True if an address is a loopback address.
bool is_loopback(const std::string& address);

/// True if a request's Host header is valid for a page of a loopback server. Another name that
/// resolves to this host indicates a foreign page (DNS rebinding).
bool is_own_host(const std::string& host, const std::string& address, int port);

/// Compares two texts in a time that does not reveal where they differ.
bool is_same_secret(const std::string& a, const std::string& b);

}  // namespace orchard::procs

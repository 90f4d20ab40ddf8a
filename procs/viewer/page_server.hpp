// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "viewer/page_content.hpp"

namespace orchard::procs {

/// Where the page is served, and to whom.
struct PageServerOptions {
  std::string address = "127.0.0.1";
  int port = 8420;
  bool may_move = true;  ///< to one of the next ports when that one is taken
  std::string token;     ///< who asks from elsewhere must know it; empty: nobody else is let in
};

/// Serves a page and its events over HTTP, in threads of its own.
///
/// `/` the page; `/api/stream` events as they come (server-sent events); `/api/NAME` what the
/// content has there, else 404. Every other method than GET is 405, but for POST to `/api/edit`
/// where the content can be edited, from its own page.
class PageServer {
 public:
  /// Streams at once at most, each of which holds a thread; one more is told to come later (503).
  static constexpr int kStreamsMax = 32;

  /// Throws std::runtime_error when the address cannot be had, or is no loopback one and there is
  /// no token. `content` outlives this.
  PageServer(PageContent& content, const PageServerOptions& options);
  ~PageServer();

  /// "http://127.0.0.1:8420/"
  const std::string& url() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether an address is this host alone.
bool is_loopback(const std::string& address);

/// Whether a request's Host is one that a page of a loopback server can have: a name that points
/// elsewhere, but resolves to here, is a stranger's page (DNS rebinding).
bool is_own_host(const std::string& host, const std::string& address, int port);

/// Whether two texts are the same, in a time that does not tell where they differ.
bool is_same_secret(const std::string& a, const std::string& b);

}  // namespace orchard::procs

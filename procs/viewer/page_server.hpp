// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "view/live_state.hpp"

namespace orchard::procs {

/// Answer to an HTTP request.
struct PageAnswer {
  int status = 200;
  std::string type = "application/json";
  std::string body;
};

/// Content of a served page. Called from several threads concurrently.
class PageContent {
 public:
  /// Query parameters of the URL; limited in size, not validated.
  using Parameters = std::map<std::string, std::string>;

  virtual ~PageContent() = default;

  /// The page itself, as HTML.
  virtual std::string page() const = 0;

  /// Events that a client has not seen yet; see view::LiveState::events_for().
  virtual std::vector<std::string> events_for(view::ViewerProgress& seen, bool& is_more) const = 0;

  /// The first event of each stream.
  virtual std::string hello() const { return "{\"kind\":\"hello\"}"; }

  /// Content of /api/NAME; none: 404.
  virtual std::optional<PageAnswer> get(const std::string& name, const Parameters& parameters) = 0;

  /// True if users may correct the map with edit().
  virtual bool can_edit() const { return false; }

  /// Makes the correction requested by a page in JSON.
  virtual PageAnswer edit(const std::string& json) = 0;
};

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

}  // namespace orchard::procs

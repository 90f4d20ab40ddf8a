// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
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

}  // namespace orchard::procs

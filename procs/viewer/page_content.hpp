// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "view/live_state.hpp"

namespace orchard::procs {

/// What a page server answers.
struct PageAnswer {
  int status = 200;
  std::string type = "application/json";
  std::string body;
};

/// What is behind a served page. Called from many threads at once.
class PageContent {
 public:
  /// Words after the question mark of an address; bounded, not checked.
  using Parameters = std::map<std::string, std::string>;

  virtual ~PageContent() = default;

  /// The page itself, as HTML.
  virtual std::string page() const = 0;

  /// Events that are new to somebody who looks on; see view::LiveState::events_for().
  virtual std::vector<std::string> events_for(view::Seen& seen, bool& is_more) const = 0;

  /// The first event of each stream.
  virtual std::string hello() const { return "{\"kind\":\"hello\"}"; }

  /// What stands at /api/NAME; none: nothing does.
  virtual std::optional<PageAnswer> get(const std::string& name, const Parameters& parameters) = 0;

  /// Whether people may correct the map by edit().
  virtual bool can_edit() const { return false; }

  /// Makes a correction that a page asks for in JSON.
  virtual PageAnswer edit(const std::string& json) = 0;
};

}  // namespace orchard::procs

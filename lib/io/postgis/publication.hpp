// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/georeference.hpp"
#include "mapping/landmark.hpp"

namespace orchard::io {

/// A map as it goes into the database.
struct Publication {
  struct Name {
    std::string row, tree;
  };

  std::string block;
  std::string date;  ///< YYYY-MM-DD
  std::string source;
  std::vector<mapping::Landmark> landmarks;
  std::vector<Name> names;  ///< of the landmarks in their order; empty: none are known
  std::optional<geometry::Georeference> georeference;
};

struct PublishedCounts {
  std::int64_t num_published = 0;
  std::int64_t num_replaced = 0;  ///< of an earlier publication of this block and date; kept apart
};

/// Called with what is done of what there is; may throw, and then nothing is published.
using PublishProgress = std::function<void(std::uint64_t done, std::uint64_t total)>;

/// Puts a map into PostGIS in one transaction: all of it or nothing, whatever dies in between. Two
/// publishers of one block wait for each other. Makes the tables when they are missing
/// (orchard_schema.sql). `url` as libpq has it, without a password: that comes from PGPASSWORD,
/// .pgpass or a service file, and is printed nowhere. Throws FileError for a URL that is none,
/// std::runtime_error with the server's own sentence when it refuses.
PublishedCounts publish(const std::string& url, const Publication& publication,
                        const PublishProgress& progress);

}  // namespace orchard::io

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

/// A map to be published in the database.
struct Publication {
  struct Name {
    std::string row, tree;
  };

  std::string block;
  std::string date;    ///< YYYY-MM-DD
  std::string source;  ///< name of the map, shown to all who read the table
  std::vector<mapping::Landmark> landmarks;
  std::vector<Name> names;  ///< in the order of the landmarks; empty: no names
  std::optional<geometry::Georeference> georeference;
};

struct PublishedCounts {
  std::int64_t num_published = 0;
  std::int64_t num_replaced = 0;  ///< from an earlier publication of the date; kept elsewhere
};

/// Receives the progress; may throw, and then nothing is published.
using PublishProgress = std::function<void(std::uint64_t done, std::uint64_t total)>;

/// Publishes a map to PostGIS in one transaction: completely or not at all. Two publishers of one
/// block wait for each other. Creates missing tables (orchard_schema.sql). `url`: in libpq's form,
/// without a password, which comes from PGPASSWORD, .pgpass or a service file and is never printed.
/// Throws FileError for an invalid URL and std::runtime_error with the server's message when it
/// refuses.
PublishedCounts publish(const std::string& url, const Publication& publication,
                        const PublishProgress& progress);

}  // namespace orchard::io

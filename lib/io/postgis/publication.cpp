// SPDX-License-Identifier: BSD-3-Clause
#include "io/postgis/publication.hpp"

#include "detection/detection.hpp"
#include "io/postgis/connection.hpp"
#include "io/postgis/qgis_tables.hpp"
#include "io/postgis/schema_text.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

constexpr std::size_t kLinesAtOnce = 1000;

/// Appends a text in COPY's format.
void append_text(const std::string& text, std::string& line) {
  for (const char c : text) {
    switch (c) {
      case '\\':
        line += "\\\\";
        break;
      case '\t':
        line += "\\t";
        break;
      case '\n':
        line += "\\n";
        break;
      case '\r':
        line += "\\r";
        break;
      default:
        line += c;
    }
  }
}

void append_name(const std::string& name, std::string& line) {
  line += '\t';
  if (name.empty()) {
    line += "\\N";
  } else {
    append_text(name, line);
  }
}

void append_number(std::int32_t number, std::string& line) {
  line += '\t';
  line += number == 0 ? "\\N" : std::to_string(number);
}

/// Appends the columns of `incoming`, below.
void append_line(const mapping::Landmark& l, const Publication::Name* name,
                 const std::optional<geometry::Georeference>& georeference, std::string& lines) {
  lines += std::to_string(l.id);
  lines += '\t';
  lines += detection::label_text(l.label);
  append_number(l.row, lines);
  append_number(l.position, lines);
  append_name(name ? name->row : std::string(), lines);
  append_name(name ? name->tree : std::string(), lines);
  for (const double value : {l.x_m, l.y_m, l.se_x_m, l.se_y_m, l.width_m}) {
    lines += '\t';
    lines += fixed_text(value, 4);
  }
  lines += '\t';
  lines += l.width_sd_m > 0.0 ? fixed_text(l.width_sd_m, 4) : "\\N";
  lines += '\t';
  lines += fixed_text(l.probability, 4);
  lines += '\t';
  lines += std::to_string(l.num_observations);
  if (georeference) {
    const geometry::Geodetic place = geometry::geodetic_of(*georeference, {l.x_m, l.y_m});
    lines += '\t' + fixed_text(place.longitude_deg, 9) + '\t' + fixed_text(place.latitude_deg, 9);
  } else {
    lines += "\t\\N\t\\N";
  }
  lines += '\n';
}

/// Creates the tables under a lock, because concurrent creation conflicts in the catalogue.
void make_tables(PostgresConnection& connection) {
  connection.run("BEGIN");
  connection.run("SELECT pg_advisory_xact_lock(hashtextextended('orchard.schema', 0))");
  const bool is_there = connection.run(
                            "SELECT WHERE to_regclass('orchard.tree') IS NOT NULL AND "
                            "to_regclass('orchard.tree_now') IS NOT NULL",
                            {}) == 1;
  if (!is_there) connection.run(schema_text());
  style_for_qgis(connection);
  connection.run("COMMIT");
}

void send(PostgresConnection& connection, const Publication& publication,
          const PublishProgress& progress) {
  connection.run(
      "CREATE TEMPORARY TABLE incoming (id integer PRIMARY KEY, class text, \"row\" integer, "
      "\"position\" integer, row_name text, tree_name text, x_m float8, y_m float8, se_x_m float8, "
      "se_y_m float8, width_m float8, width_sd_m float8, probability float8, n integer, "
      "longitude float8, latitude float8) ON COMMIT DROP");
  connection.begin_copy("COPY incoming FROM STDIN");
  const std::size_t total = publication.landmarks.size();
  std::string lines;
  for (std::size_t i = 0; i < total; ++i) {
    append_line(publication.landmarks[i],
                i < publication.names.size() ? &publication.names[i] : nullptr,
                publication.georeference, lines);
    if ((i + 1) % kLinesAtOnce != 0 && i + 1 < total) continue;
    connection.copy(lines);
    lines.clear();
    progress(i + 1, total);
  }
  connection.end_copy();
}

}  // namespace

PublishedCounts publish(const std::string& url, const Publication& publication,
                        const PublishProgress& progress) {
  PostgresConnection connection(url);
  make_tables(connection);
  const std::vector<std::string> visit{publication.block, publication.date};
  connection.run("BEGIN");
  connection.run("SELECT pg_advisory_xact_lock(hashtextextended('orchard.block.' || $1, 0))",
                 {publication.block});
  send(connection, publication, progress);
  PublishedCounts counts;
  // rows that change or disappear are kept in another table
  counts.num_replaced = connection.run(
      "INSERT INTO orchard.tree_replaced SELECT t.*, now() FROM orchard.tree t "
      "LEFT JOIN incoming i USING (id) WHERE t.block = $1 AND t.date = $2::date AND "
      "(i.id IS NULL OR (t.class, t.\"row\", t.\"position\", t.row_name, t.tree_name, t.x_m, "
      "t.y_m, "
      "t.se_x_m, t.se_y_m, t.width_m, t.width_sd_m, t.probability, t.n) IS DISTINCT FROM "
      "(i.class, i.\"row\", i.\"position\", i.row_name, i.tree_name, i.x_m, i.y_m, i.se_x_m, "
      "i.se_y_m, i.width_m, i.width_sd_m, i.probability, i.n))",
      visit);
  connection.run(
      "DELETE FROM orchard.tree t WHERE t.block = $1 AND t.date = $2::date AND NOT EXISTS "
      "(SELECT FROM incoming i WHERE i.id = t.id)",
      visit);
  counts.num_published = connection.run(
      "INSERT INTO orchard.tree SELECT $1, $2::date, id, class, \"row\", \"position\", row_name, "
      "tree_name, x_m, y_m, se_x_m, se_y_m, width_m, width_sd_m, probability, n, "
      "ST_SetSRID(ST_MakePoint(longitude, latitude), 4326) FROM incoming "
      "ON CONFLICT (block, date, id) DO UPDATE SET class = excluded.class, "
      "\"row\" = excluded.\"row\", \"position\" = excluded.\"position\", "
      "row_name = excluded.row_name, tree_name = excluded.tree_name, x_m = excluded.x_m, "
      "y_m = excluded.y_m, se_x_m = excluded.se_x_m, se_y_m = excluded.se_y_m, "
      "width_m = excluded.width_m, width_sd_m = excluded.width_sd_m, "
      "probability = excluded.probability, n = excluded.n, place = excluded.place",
      visit);
  connection.run(
      "INSERT INTO orchard.visit (block, date, num_trees, source) SELECT $1, $2::date, "
      "(SELECT count(*) FROM incoming WHERE class = 'tree'), $3 ON CONFLICT (block, date) "
      "DO UPDATE SET num_trees = excluded.num_trees, source = excluded.source, "
      "published_at = now(), published_by = session_user",
      {publication.block, publication.date, publication.source});
  connection.run("COMMIT");
  return counts;
}

}  // namespace orchard::io

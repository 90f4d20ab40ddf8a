// SPDX-License-Identifier: BSD-3-Clause
#include "io/postgis/publication.hpp"

#include <libpq-fe.h>

#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "detection/detection.hpp"
#include "io/file_error.hpp"
#include "io/gis/qgis_style.hpp"
#include "io/postgis/schema_text.hpp"
#include "mapping/kind.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

struct ResultClearer {
  void operator()(PGresult* result) const { PQclear(result); }
};
using Result = std::unique_ptr<PGresult, ResultClearer>;

/// The first line of a server message, which states the error; the others refer to our SQL.
std::string first_line(const char* message) {
  std::string text = message == nullptr ? "" : message;
  text = text.substr(0, text.find('\n'));
  return text.empty() ? "no reason given" : text;
}

void require_no_password(const std::string& url) {
  char* error = nullptr;
  PQconninfoOption* options = PQconninfoParse(url.c_str(), &error);
  if (options == nullptr) {
    PQfreemem(error);  // it may contain the password
    throw FileError(
        "--to: this is not a PostgreSQL URL; give one such as postgresql://user@host/database");
  }
  bool has_password = false;
  for (const PQconninfoOption* o = options; o->keyword != nullptr; ++o) {
    if (std::string(o->keyword) == "password" && o->val != nullptr) has_password = true;
  }
  PQconninfoFree(options);
  if (has_password) {
    throw FileError(
        "--to: a password on the command line is visible to everyone on this machine; put it into "
        "~/.pgpass (mode 600), a service file or PGPASSWORD instead");
  }
}

/// Label: row and tree such as "3/14", else "#id".
constexpr char kKind[] = R"(if("class" = 'tree' AND "row" IS NULL, 'trunk', "class"))";
constexpr char kLabel[] =
    "coalesce(coalesce(\"row_name\", to_string(\"row\")) || '/' || coalesce(\"tree_name\", "
    "to_string(\"position\")), '#' || to_string(\"id\"))";

/// The columns of layer_styles as created by QGIS 3.
constexpr char kBegin[] =
    "DO $do$ BEGIN "
    "CREATE TABLE IF NOT EXISTS public.layer_styles (id serial PRIMARY KEY, "
    "f_table_catalog varchar, f_table_schema varchar, f_table_name varchar, "
    "f_geometry_column varchar, stylename text, styleqml xml, stylesld xml, useasdefault boolean, "
    "description text, owner varchar(63) DEFAULT CURRENT_USER, ui xml, "
    "update_time timestamp DEFAULT CURRENT_TIMESTAMP, type varchar); "
    "INSERT INTO public.layer_styles (f_table_catalog, f_table_schema, f_table_name, "
    "f_geometry_column, stylename, styleqml, useasdefault, description) "
    "SELECT current_database(), 'orchard', t.name, 'place', 'orchard', XMLPARSE(DOCUMENT $qml$";
constexpr char kEnd[] =
    "$qml$), true, 'Trees and other things; label: row/tree, or #id' "
    "FROM (VALUES ('tree'), ('tree_now'), ('tree_replaced')) AS t (name) WHERE NOT EXISTS "
    "(SELECT FROM public.layer_styles s WHERE s.f_table_catalog = current_database() "
    "AND s.f_table_schema = 'orchard' AND s.f_table_name = t.name); "
    "BEGIN GRANT SELECT ON public.layer_styles TO orchard_reader, orchard_writer; "
    "EXCEPTION WHEN insufficient_privilege OR undefined_object THEN NULL; END; "
    "EXCEPTION WHEN insufficient_privilege OR undefined_column THEN NULL; "
    "END $do$";

/// A connection to PostgreSQL. Errors are std::runtime_error with the server's message in one
/// sentence. Uncommitted changes are rolled back when the connection ends.
class PostgresConnection {
 public:
  /// Waits at most ten seconds unless the URL sets connect_timeout. Throws FileError for an invalid
  /// URL or one with a password.
  explicit PostgresConnection(const std::string& url) {
    require_no_password(url);
    const char* timeout_s = std::getenv("PGCONNECT_TIMEOUT");
    // Later entries of the list win, so those of the URL do. A machine that loses its power sends
    // no farewell: half a minute without a sign of life ends the connection.
    const char* keys[] = {"application_name", "client_encoding",  "connect_timeout",
                          "keepalives_idle",  "keepalives_count", "keepalives_interval",
                          "tcp_user_timeout", "dbname",           nullptr};
    const char* values[] = {"orchard publish",
                            "UTF8",
                            timeout_s != nullptr ? timeout_s : "10",
                            "10",
                            "2",
                            "10",
                            "30000",
                            url.c_str(),
                            nullptr};
    connection_.reset(PQconnectdbParams(keys, values, 1));
    if (PQstatus(connection_.get()) != CONNECTION_OK) fail("no connection to the database");
    PQsetNoticeProcessor(
        connection_.get(), [](void*, const char*) {}, nullptr);
  }
  PostgresConnection(const PostgresConnection&) = delete;
  PostgresConnection& operator=(const PostgresConnection&) = delete;

  /// Executes several statements without arguments.
  void run(const char* statements) {
    const Result result(PQexec(connection_.get(), statements));
    const ExecStatusType status = PQresultStatus(result.get());
    if (status != PGRES_COMMAND_OK && status != PGRES_TUPLES_OK) fail_request();
  }

  /// Ends the transaction. When the connection is lost here, nobody knows whether it was.
  void commit() {
    const Result result(PQexec(connection_.get(), "COMMIT"));
    if (PQresultStatus(result.get()) == PGRES_COMMAND_OK) return;
    if (PQstatus(connection_.get()) == CONNECTION_OK) fail_request();
    throw std::runtime_error("the connection was lost at the last step: " + reason() +
                             "; the map may or may not be published: publish it again, which "
                             "replaces it");
  }

  /// Executes one statement with $1, $2 ...; returns the number of rows it changed or, for a
  /// SELECT, returned.
  std::int64_t run(const char* statement, const std::vector<std::string>& arguments) {
    std::vector<const char*> values;
    for (const std::string& a : arguments) values.push_back(a.c_str());
    const Result result(PQexecParams(connection_.get(), statement, static_cast<int>(values.size()),
                                     nullptr, values.data(), nullptr, nullptr, 0));
    const ExecStatusType status = PQresultStatus(result.get());
    if (status == PGRES_TUPLES_OK) return PQntuples(result.get());
    if (status != PGRES_COMMAND_OK) fail_request();
    return std::strtoll(PQcmdTuples(result.get()), nullptr, 10);
  }

  /// Sends text lines to `statement`, a COPY ... FROM STDIN.
  void begin_copy(const char* statement) {
    const Result result(PQexec(connection_.get(), statement));
    if (PQresultStatus(result.get()) != PGRES_COPY_IN) fail_request();
  }
  void copy(std::string_view lines) {
    if (PQputCopyData(connection_.get(), lines.data(), static_cast<int>(lines.size())) != 1) {
      fail_request();
    }
  }
  void end_copy() {
    if (PQputCopyEnd(connection_.get(), nullptr) != 1) fail_request();
    bool is_good = true;
    while (Result result{PQgetResult(connection_.get())}) {
      is_good = is_good && PQresultStatus(result.get()) == PGRES_COMMAND_OK;
    }
    if (!is_good) fail_request();
  }

 private:
  std::string reason() const { return first_line(PQerrorMessage(connection_.get())); }

  [[noreturn]] void fail(const char* what) const {
    throw std::runtime_error(std::string(what) + ": " + reason() + "; nothing was published");
  }
  [[noreturn]] void fail_request() const {
    const bool is_connected = PQstatus(connection_.get()) == CONNECTION_OK;
    fail(is_connected ? "the database refused the request"
                      : "the connection to the database was lost");
  }

  struct Closer {
    void operator()(pg_conn* connection) const { PQfinish(connection); }
  };
  std::unique_ptr<pg_conn, Closer> connection_;
};

/// Adds a default style (colours, labels) to each published table that has none, as in a map's
/// GeoPackage. QGIS reads styles from `public.layer_styles`; without the right to write there, the
/// tables are published without a style.
void style_for_qgis(PostgresConnection& connection) {
  connection.run((kBegin + qml_text(landmark_style(kLabel, kKind)) + kEnd).c_str());
}

constexpr std::size_t kLinesAtOnce = 1000;

/// Appends a text in COPY's format.
void append_text(const std::string& text, std::string& line) {
  constexpr std::string_view kEscaped = "\\\t\n\r", kLetters = "\\tnr";
  for (const char c : text) {
    const std::size_t at = kEscaped.find(c);
    if (at != std::string_view::npos) line += '\\';
    line += at == std::string_view::npos ? c : kLetters[at];
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
  const auto append_known = [&lines](double value, bool is_known) {
    lines += '\t';
    lines += is_known ? fixed_text(value, 4) : "\\N";
  };
  append_known(l.width_sd_m, l.width_sd_m > 0.0);
  append_known(l.z_m, l.z_sd_m > 0.0);
  append_known(l.z_sd_m, l.z_sd_m > 0.0);
  append_known(l.probability, true);
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
                            "SELECT WHERE to_regclass('orchard.tree_now') IS NOT NULL AND EXISTS "
                            "(SELECT FROM pg_attribute WHERE attname = 'z_sd_m' AND NOT "
                            "attisdropped AND attrelid = to_regclass('orchard.tree_replaced'))",
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
      "se_y_m float8, width_m float8, width_sd_m float8, z_m float8, z_sd_m float8, "
      "probability float8, n integer, longitude float8, latitude float8) ON COMMIT DROP");
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
      "INSERT INTO orchard.tree_replaced (block, date, id, class, \"row\", \"position\", row_name, "
      "tree_name, x_m, y_m, se_x_m, se_y_m, width_m, width_sd_m, probability, n, place, z_m, "
      "z_sd_m) "
      "SELECT t.block, t.date, t.id, t.class, t.\"row\", t.\"position\", t.row_name, t.tree_name, "
      "t.x_m, t.y_m, t.se_x_m, t.se_y_m, t.width_m, t.width_sd_m, t.probability, t.n, t.place, "
      "t.z_m, t.z_sd_m FROM orchard.tree t "
      "LEFT JOIN incoming i USING (id) WHERE t.block = $1 AND t.date = $2::date AND "
      "(i.id IS NULL OR (t.class, t.\"row\", t.\"position\", t.row_name, t.tree_name, t.x_m, "
      "t.y_m, "
      "t.se_x_m, t.se_y_m, t.width_m, t.width_sd_m, t.probability, t.n, t.z_m, "
      "t.z_sd_m) IS DISTINCT FROM "
      "(i.class, i.\"row\", i.\"position\", i.row_name, i.tree_name, i.x_m, i.y_m, i.se_x_m, "
      "i.se_y_m, i.width_m, i.width_sd_m, i.probability, i.n, i.z_m, i.z_sd_m))",
      visit);
  connection.run(
      "DELETE FROM orchard.tree t WHERE t.block = $1 AND t.date = $2::date AND NOT EXISTS "
      "(SELECT FROM incoming i WHERE i.id = t.id)",
      visit);
  counts.num_published = connection.run(
      "INSERT INTO orchard.tree (block, date, id, class, \"row\", \"position\", row_name, "
      "tree_name, x_m, y_m, se_x_m, se_y_m, width_m, width_sd_m, probability, n, place, z_m, "
      "z_sd_m) "
      "SELECT $1, $2::date, id, class, \"row\", \"position\", row_name, "
      "tree_name, x_m, y_m, se_x_m, se_y_m, width_m, width_sd_m, probability, n, "
      "ST_SetSRID(ST_MakePoint(longitude, latitude), 4326), z_m, z_sd_m FROM incoming "
      "ON CONFLICT (block, date, id) DO UPDATE SET class = excluded.class, "
      "\"row\" = excluded.\"row\", \"position\" = excluded.\"position\", "
      "row_name = excluded.row_name, tree_name = excluded.tree_name, x_m = excluded.x_m, "
      "y_m = excluded.y_m, se_x_m = excluded.se_x_m, se_y_m = excluded.se_y_m, "
      "width_m = excluded.width_m, width_sd_m = excluded.width_sd_m, "
      "probability = excluded.probability, n = excluded.n, place = excluded.place, "
      "z_m = excluded.z_m, z_sd_m = excluded.z_sd_m",
      visit);
  connection.run(
      "INSERT INTO orchard.visit (block, date, num_trees, source) SELECT $1, $2::date, "
      "$3::integer, $4 ON CONFLICT (block, date) "
      "DO UPDATE SET num_trees = excluded.num_trees, source = excluded.source, "
      "published_at = now(), published_by = session_user",
      {publication.block, publication.date,
       std::to_string(mapping::counted_trunks(publication.landmarks).size()), publication.source});
  connection.commit();
  return counts;
}

}  // namespace orchard::io

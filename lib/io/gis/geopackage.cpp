// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/geopackage.hpp"

#include <fmt/core.h>
#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "io/byte_fields.hpp"
#include "io/file_error.hpp"

namespace orchard::io {
namespace {

/// Time of every change: the time of day would make each file different.
constexpr char kFixedDate[] = "2000-01-01T00:00:00.000Z";
constexpr int kLocalSystemId = 100000;

constexpr char kGeodeticSystem[] =
    R"(GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563,AUTHORITY["EPSG","7030"]],)"
    R"(AUTHORITY["EPSG","6326"]],PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],)"
    R"(UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4326"]])";

constexpr char kTables[] = R"(
  PRAGMA application_id = 0x47504B47;
  PRAGMA user_version = 10200;
  CREATE TABLE gpkg_spatial_ref_sys (
    srs_name TEXT NOT NULL, srs_id INTEGER NOT NULL PRIMARY KEY, organization TEXT NOT NULL,
    organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);
  CREATE TABLE gpkg_contents (
    table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE,
    description TEXT DEFAULT '',
    last_change DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ', 'now')),
    min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE,
    srs_id INTEGER REFERENCES gpkg_spatial_ref_sys(srs_id));
  CREATE TABLE gpkg_geometry_columns (
    table_name TEXT NOT NULL UNIQUE REFERENCES gpkg_contents(table_name),
    column_name TEXT NOT NULL, geometry_type_name TEXT NOT NULL,
    srs_id INTEGER NOT NULL REFERENCES gpkg_spatial_ref_sys(srs_id),
    z TINYINT NOT NULL, m TINYINT NOT NULL, PRIMARY KEY (table_name, column_name));
  CREATE TABLE gpkg_extensions (
    table_name TEXT, column_name TEXT, extension_name TEXT NOT NULL, definition TEXT NOT NULL,
    scope TEXT NOT NULL, UNIQUE (table_name, column_name, extension_name));
)";

constexpr char kMetadataTables[] = R"(
  CREATE TABLE gpkg_metadata (
    id INTEGER PRIMARY KEY NOT NULL, md_scope TEXT NOT NULL DEFAULT 'dataset',
    md_standard_uri TEXT NOT NULL, mime_type TEXT NOT NULL DEFAULT 'text/xml',
    metadata TEXT NOT NULL DEFAULT '');
  CREATE TABLE gpkg_metadata_reference (
    reference_scope TEXT NOT NULL, table_name TEXT, column_name TEXT, row_id_value INTEGER,
    timestamp DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ', 'now')),
    md_file_id INTEGER NOT NULL REFERENCES gpkg_metadata(id),
    md_parent_id INTEGER REFERENCES gpkg_metadata(id));
)";

/// The triggers that keep the spatial index of a table right in a program that edits; such a
/// program has the functions.
constexpr char kIndexTriggers[] = R"(
  CREATE TRIGGER "rtree_{0}_geom_insert" AFTER INSERT ON "{0}"
    WHEN NEW.geom NOTNULL AND NOT ST_IsEmpty(NEW.geom)
    BEGIN INSERT OR REPLACE INTO "rtree_{0}_geom" VALUES ({1}); END;
  CREATE TRIGGER "rtree_{0}_geom_update1" AFTER UPDATE OF geom ON "{0}"
    WHEN OLD.fid = NEW.fid AND NEW.geom NOTNULL AND NOT ST_IsEmpty(NEW.geom)
    BEGIN INSERT OR REPLACE INTO "rtree_{0}_geom" VALUES ({1}); END;
  CREATE TRIGGER "rtree_{0}_geom_update2" AFTER UPDATE OF geom ON "{0}"
    WHEN OLD.fid = NEW.fid AND (NEW.geom ISNULL OR ST_IsEmpty(NEW.geom))
    BEGIN DELETE FROM "rtree_{0}_geom" WHERE id = OLD.fid; END;
  CREATE TRIGGER "rtree_{0}_geom_update3" AFTER UPDATE ON "{0}"
    WHEN OLD.fid != NEW.fid AND NEW.geom NOTNULL AND NOT ST_IsEmpty(NEW.geom)
    BEGIN DELETE FROM "rtree_{0}_geom" WHERE id = OLD.fid;
          INSERT OR REPLACE INTO "rtree_{0}_geom" VALUES ({1}); END;
  CREATE TRIGGER "rtree_{0}_geom_update4" AFTER UPDATE ON "{0}"
    WHEN OLD.fid != NEW.fid AND (NEW.geom ISNULL OR ST_IsEmpty(NEW.geom))
    BEGIN DELETE FROM "rtree_{0}_geom" WHERE id IN (OLD.fid, NEW.fid); END;
  CREATE TRIGGER "rtree_{0}_geom_delete" AFTER DELETE ON "{0}" WHEN OLD.geom NOTNULL
    BEGIN DELETE FROM "rtree_{0}_geom" WHERE id = OLD.fid; END;
  INSERT INTO gpkg_extensions VALUES ('{0}', 'geom', 'gpkg_rtree_index',
    'http://www.geopackage.org/spec120/#extension_rtree', 'write-only');
)";
constexpr char kIndexRow[] =
    "NEW.fid, ST_MinX(NEW.geom), ST_MaxX(NEW.geom), ST_MinY(NEW.geom), ST_MaxY(NEW.geom)";

/// The table in which QGIS keeps styles; it applies the default one of a layer.
constexpr char kStyles[] = R"(
  CREATE TABLE layer_styles (
    fid INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, f_table_catalog TEXT, f_table_schema TEXT,
    f_table_name TEXT, f_geometry_column TEXT, styleName TEXT, styleQML TEXT, styleSLD TEXT,
    description TEXT, owner TEXT, ui TEXT, useAsDefault BOOLEAN, update_time DATETIME);
  INSERT INTO gpkg_contents VALUES ('layer_styles', 'attributes', 'layer_styles', '', '{}',
    NULL, NULL, NULL, NULL, 0);
)";

const char* column_type(GeoType type) {
  constexpr const char* kNames[] = {"MEDIUMINT", "INTEGER", "REAL", "TEXT"};
  return kNames[static_cast<std::size_t>(type)];
}

const char* geometry_name(GeoGeometry geometry) {
  constexpr const char* kNames[] = {"POINT", "LINESTRING", "POLYGON"};
  return kNames[static_cast<std::size_t>(geometry)];
}

/// Whether a UTM zone of WGS 84 with this EPSG code (326 or 327 and the zone) is in the south.
bool is_south(int epsg) { return epsg / 100 == 327; }

std::string utm_name(int epsg) {
  return fmt::format("WGS 84 / UTM zone {}{}", epsg % 100, is_south(epsg) ? 'S' : 'N');
}

/// Its definition as WKT.
std::string utm_wkt(int epsg) {
  return fmt::format(R"(PROJCS["{}",{},PROJECTION["Transverse_Mercator"],)"
                     R"(PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",{}],)"
                     R"(PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],)"
                     R"(PARAMETER["false_northing",{}],UNIT["metre",1,AUTHORITY["EPSG","9001"]],)"
                     R"(AXIS["Easting",EAST],AXIS["Northing",NORTH],AUTHORITY["EPSG","{}"]])",
                     utm_name(epsg), kGeodeticSystem, 6 * (epsg % 100) - 183,
                     is_south(epsg) ? 10000000 : 0, epsg);
}

struct Bounds {
  double x0 = std::numeric_limits<double>::infinity(), y0 = x0, x1 = -x0, y1 = -x0;
  void add(const Eigen::Vector2d& p) {
    x0 = std::min(x0, p.x()), y0 = std::min(y0, p.y());
    x1 = std::max(x1, p.x()), y1 = std::max(y1, p.y());
  }
  bool empty() const { return x1 < x0; }
};

std::string point_bytes(const Eigen::Vector2d& p) {
  return number_bytes(p.x()) + number_bytes(p.y());
}

/// A geometry as GeoPackage stores it: a header with its bounds, then WKB.
std::string geometry_blob(GeoGeometry geometry, int system_id,
                          const std::vector<Eigen::Vector2d>& points, const Bounds& bounds,
                          const std::optional<double>& height_m) {
  constexpr std::uint8_t kVersion = 0, kLittleEndian = 1, kWithBounds = 2;
  const bool is_point = points.size() == 1;
  std::string blob = "GP" + number_bytes(kVersion);
  blob += static_cast<char>(is_point ? kLittleEndian : kLittleEndian | kWithBounds);
  blob += number_bytes(static_cast<std::uint32_t>(system_id));
  if (!is_point) {
    for (const double limit : {bounds.x0, bounds.x1, bounds.y0, bounds.y1}) {
      blob += number_bytes(limit);
    }
  }
  blob += number_bytes(kLittleEndian);
  const bool is_area = !is_point && geometry == GeoGeometry::kArea;
  constexpr std::uint32_t kWithHeight = 1000;  // of ISO's WKB
  blob += number_bytes(std::uint32_t{is_point  ? 1u
                                     : is_area ? 3u
                                               : 2u} +
                       (height_m ? kWithHeight : 0));
  if (is_area) blob += number_bytes(std::uint32_t{1});  // one ring
  if (!is_point)
    blob += number_bytes(static_cast<std::uint32_t>(points.size() + (is_area ? 1 : 0)));
  for (const Eigen::Vector2d& p : points) blob += point_bytes(p);
  if (height_m) blob += number_bytes(stored_m(*height_m));
  if (is_area) blob += point_bytes(points.front());
  return blob;
}

}  // namespace

double stored_m(double coordinate_m) { return std::round(coordinate_m * 1e4) / 1e4; }

double stored_value(double value) { return std::round(value * 1e9) / 1e9; }

void LayerFile::begin_layer(const GeoLayer& layer) {
  is_open_ = chosen_.empty() ? !has_one_layer_ || written_.empty() : chosen_ == layer.name;
  if (!is_open_) {
    left_out_.push_back(layer.name);
    return;
  }
  open_layer(layer);
  written_.emplace_back(layer.name, 0);
}

void LayerFile::add(const std::vector<GeoValue>& values,
                    const std::vector<Eigen::Vector2d>& points_map,
                    const std::optional<double>& height_m) {
  if (!is_open_) return;
  ++written_.back().second;
  write_feature(values, points_map, height_m);
}

struct GeoPackage::Impl {
  explicit Impl(const std::optional<geometry::Georeference>& g) : georeference(g) {
    require(sqlite3_open(":memory:", &database) == SQLITE_OK);
    run(kTables);
    run("BEGIN");
    const std::string insert = "INSERT INTO gpkg_spatial_ref_sys VALUES (?, ?, ?, ?, ?, ?)";
    insert_row(insert, {"Undefined Cartesian SRS", -1, "NONE", -1, "undefined",
                        "undefined Cartesian coordinate reference system"});
    insert_row(insert, {"Undefined geographic SRS", 0, "NONE", 0, "undefined",
                        "undefined geographic coordinate reference system"});
    insert_row(insert,
               {"WGS 84 geodetic", 4326, "EPSG", 4326, kGeodeticSystem,
                "longitude/latitude coordinates in decimal degrees on the WGS 84 spheroid"});
    if (georeference) {
      system_id = geometry::utm_epsg(*georeference);
      // Beyond the zones (UPS, at the poles) the code alone says which system it is.
      const bool is_utm = system_id % 100 <= 60;
      insert_row(insert, {is_utm ? utm_name(system_id) : fmt::format("EPSG:{}", system_id),
                          system_id, "EPSG", system_id,
                          is_utm ? utm_wkt(system_id) : std::string("undefined"), Value()});
    } else {
      insert_row(insert,
                 {"Orchard map (local)", system_id, "NONE", system_id, kLocalSystem, Value()});
    }
  }
  ~Impl() { close(); }

  void close() {
    sqlite3_finalize(std::exchange(insert_feature, nullptr));
    sqlite3_close(std::exchange(database, nullptr));
  }

  /// A value of a row; integers and texts besides those of a feature.
  struct Value : GeoValue {
    using GeoValue::GeoValue;
    Value(int number) : GeoValue(std::int64_t{number}) {}
    Value(const char* letters) : GeoValue(std::string(letters)) {}
    Value(const GeoValue& value) : GeoValue(value) {}
  };

  void require(bool holds) const {
    if (holds) return;
    throw SystemError(std::string("map.gpkg: SQLite cannot write it (") +
                      (database == nullptr ? "out of memory" : sqlite3_errmsg(database)) + ")");
  }
  void run(const std::string& sql) {
    require(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK);
  }
  sqlite3_stmt* prepared(const std::string& sql) {
    sqlite3_stmt* statement = nullptr;
    require(sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr) == SQLITE_OK);
    return statement;
  }
  void bind(sqlite3_stmt* statement, int column, const GeoValue& value) {
    switch (value.kind) {
      case GeoValue::Kind::kNone:
        require(sqlite3_bind_null(statement, column) == SQLITE_OK);
        break;
      case GeoValue::Kind::kInteger:
        require(sqlite3_bind_int64(statement, column, value.integer) == SQLITE_OK);
        break;
      case GeoValue::Kind::kReal:
        require(sqlite3_bind_double(statement, column, stored_value(value.real)) == SQLITE_OK);
        break;
      case GeoValue::Kind::kText:
        require(sqlite3_bind_text(statement, column, value.text.c_str(),
                                  static_cast<int>(value.text.size()),
                                  SQLITE_TRANSIENT) == SQLITE_OK);
        break;
    }
  }
  void step(sqlite3_stmt* statement) {
    require(sqlite3_step(statement) == SQLITE_DONE);
    require(sqlite3_reset(statement) == SQLITE_OK);
  }
  void insert_row(const std::string& sql, const std::vector<Value>& values) {
    sqlite3_stmt* statement = prepared(sql);
    for (std::size_t i = 0; i < values.size(); ++i) {
      bind(statement, static_cast<int>(i) + 1, values[i]);
    }
    const int result = sqlite3_step(statement);
    sqlite3_finalize(statement);
    require(result == SQLITE_DONE);
  }
  Eigen::Vector2d stored(const Eigen::Vector2d& p_map) const {
    const Eigen::Vector2d p = georeference ? geometry::utm_of(*georeference, p_map) : p_map;
    return {stored_m(p.x()), stored_m(p.y())};
  }
  void close_layer();
  void write_styles();

  sqlite3* database = nullptr;
  std::optional<geometry::Georeference> georeference;
  int system_id = kLocalSystemId;
  sqlite3_stmt* insert_feature = nullptr;
  std::optional<GeoLayer> layer;  ///< the current one
  std::vector<Bounds> bounds;     ///< of its features
  std::vector<GeoLayer> styled;
};

/// Completes the current layer: its extent, its spatial index.
void GeoPackage::Impl::close_layer() {
  if (!layer) return;
  sqlite3_finalize(std::exchange(insert_feature, nullptr));
  const std::string name = layer->name;
  Bounds all;
  for (const Bounds& b : bounds) all.add({b.x0, b.y0}), all.add({b.x1, b.y1});
  const auto limit = [&all](double value) { return all.empty() ? Value() : Value(value); };
  insert_row("INSERT INTO gpkg_contents VALUES (?, 'features', ?, ?, ?, ?, ?, ?, ?, ?)",
             {name.c_str(), name.c_str(), layer->description, kFixedDate, limit(all.x0),
              limit(all.y0), limit(all.x1), limit(all.y1), system_id});
  constexpr int kProhibited = 0, kOptional = 2;
  insert_row("INSERT INTO gpkg_geometry_columns VALUES (?, 'geom', ?, ?, ?, 0)",
             {name.c_str(), geometry_name(layer->geometry), system_id,
              layer->has_heights ? kOptional : kProhibited});
  run(fmt::format("CREATE VIRTUAL TABLE \"rtree_{}_geom\" USING rtree(id, minx, maxx, miny, maxy)",
                  name));
  sqlite3_stmt* insert =
      prepared(fmt::format("INSERT INTO \"rtree_{}_geom\" VALUES (?, ?, ?, ?, ?)", name));
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    bind(insert, 1, static_cast<std::int64_t>(i) + 1);
    int column = 2;
    for (const double value : {bounds[i].x0, bounds[i].x1, bounds[i].y0, bounds[i].y1}) {
      bind(insert, column++, value);
    }
    step(insert);
  }
  sqlite3_finalize(insert);
  run(fmt::format(kIndexTriggers, name, kIndexRow));
  bounds.clear();
  layer.reset();
}

void GeoPackage::Impl::write_styles() {
  if (styled.empty()) return;
  run(fmt::format(kStyles, kFixedDate));
  for (const GeoLayer& of : styled) {
    insert_row(
        "INSERT INTO layer_styles VALUES (NULL, '', '', ?, 'geom', ?, ?, '', ?, '', '', 1, ?)",
        {of.name, of.name, of.qml.c_str(), of.description, kFixedDate});
  }
}

GeoPackage::GeoPackage(const std::optional<geometry::Georeference>& georeference)
    : LayerFile(false), impl_(std::make_unique<Impl>(georeference)) {}

GeoPackage::~GeoPackage() = default;

void GeoPackage::set_metadata(const char* name, const std::string& value) {
  Impl& m = *impl_;
  m.run(kMetadataTables);
  m.insert_row(
      "INSERT INTO gpkg_metadata VALUES (1, 'dataset', 'http://gdal.org', 'text/xml', ?)",
      {fmt::format("<GDALMultiDomainMetadata>\n  <Metadata>\n    <MDI key=\"{}\">{}</MDI>\n"
                   "  </Metadata>\n</GDALMultiDomainMetadata>\n",
                   name, value)});
  m.insert_row(
      "INSERT INTO gpkg_metadata_reference VALUES ('geopackage', NULL, NULL, NULL, ?, 1, NULL)",
      {kFixedDate});
  for (const char* table : {"gpkg_metadata", "gpkg_metadata_reference"}) {
    m.insert_row("INSERT INTO gpkg_extensions VALUES (?, NULL, 'gpkg_metadata', ?, 'read-write')",
                 {table, "http://www.geopackage.org/spec120/#extension_metadata"});
  }
}

void GeoPackage::open_layer(const GeoLayer& layer) {
  Impl& m = *impl_;
  m.close_layer();
  m.layer = layer;
  std::string columns, places = "NULL, ?";
  for (const GeoField& field : layer.fields) {
    columns += fmt::format(", \"{}\" {}", field.name, column_type(field.type));
    places += ", ?";
  }
  m.run(
      fmt::format("CREATE TABLE \"{}\" (fid INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, geom {}{})",
                  layer.name, geometry_name(layer.geometry), columns));
  m.insert_feature = m.prepared(fmt::format("INSERT INTO \"{}\" VALUES ({})", layer.name, places));
  if (!layer.qml.empty()) m.styled.push_back(layer);
}

void GeoPackage::write_feature(const std::vector<GeoValue>& values,
                               const std::vector<Eigen::Vector2d>& points_map,
                               const std::optional<double>& height_m) {
  Impl& m = *impl_;
  std::vector<Eigen::Vector2d> points;
  points.reserve(points_map.size());
  Bounds bounds;
  for (const Eigen::Vector2d& p_map : points_map) {
    points.push_back(m.stored(p_map));
    bounds.add(points.back());
  }
  const std::string geometry =
      geometry_blob(m.layer->geometry, m.system_id, points, bounds, height_m);
  m.require(sqlite3_bind_blob(m.insert_feature, 1, geometry.data(),
                              static_cast<int>(geometry.size()), SQLITE_TRANSIENT) == SQLITE_OK);
  for (std::size_t i = 0; i < values.size(); ++i) {
    m.bind(m.insert_feature, static_cast<int>(i) + 2, values[i]);
  }
  m.step(m.insert_feature);
  m.bounds.push_back(bounds);
}

std::string GeoPackage::finish() {
  Impl& m = *impl_;
  m.close_layer();
  m.write_styles();
  m.run("COMMIT");
  sqlite3_int64 size = 0;
  const std::unique_ptr<unsigned char, void (*)(void*)> bytes(
      sqlite3_serialize(m.database, "main", &size, 0), sqlite3_free);
  m.require(bytes != nullptr);
  m.close();  // three copies of a large map at once would be one too many
  return std::string(reinterpret_cast<const char*>(bytes.get()), static_cast<std::size_t>(size));
}

}  // namespace orchard::io

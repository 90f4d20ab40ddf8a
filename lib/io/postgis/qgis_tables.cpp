// SPDX-License-Identifier: BSD-3-Clause
#include "io/postgis/qgis_tables.hpp"

#include <string>

#include "io/gis/qgis_style.hpp"
#include "io/postgis/connection.hpp"

namespace orchard::io {
namespace {

/// Label: row and tree such as "3/14", else "#id".
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

}  // namespace

void style_for_qgis(PostgresConnection& connection) {
  connection.run((kBegin + qml_text(landmark_style(kLabel)) + kEnd).c_str());
}

}  // namespace orchard::io

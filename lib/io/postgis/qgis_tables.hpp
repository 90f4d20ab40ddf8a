// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::io {

class PostgresConnection;

/// Lets QGIS draw the published trees in colours and with their numbers, as it does a map's
/// GeoPackage: a style for each table that has none, in `public.layer_styles`, where QGIS keeps
/// styles. Whoever may not write there publishes without one.
void style_for_qgis(PostgresConnection& connection);

}  // namespace orchard::io

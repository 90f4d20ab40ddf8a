// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::io {

class PostgresConnection;

/// Adds a default style (colours, labels) to each published table that has none, as in a map's
/// GeoPackage. QGIS reads styles from `public.layer_styles`; without the right to write there, the
/// tables are published without a style.
void style_for_qgis(PostgresConnection& connection);

}  // namespace orchard::io

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::io {

/// How QGIS draws features of one kind; colours are "red,green,blue".
struct QgisSymbol {
  const char* value;   ///< of the field that tells kinds apart; "" where there is one kind
  const char* legend;  ///< in words
  const char* shape;   ///< of a marker: circle, square, diamond, cross_fill ...; of a line: solid,
                       ///< dash; of an area: solid
  const char* colour;
  double size_mm;  ///< of a marker; of a line its width, of an area its border's
};

/// A layer's style as QGIS keeps it (QML, of QGIS 3): points, lines or areas by kind, and a label.
struct QgisStyle {
  bool is_line = false;
  bool is_area = false;
  const char* field = "";  ///< that tells kinds apart; "": there is one
  std::vector<QgisSymbol> symbols;
  const char* label = "";  ///< expression; "": none
  double label_size_pt = 7.0;
};

/// Trees green, other things red, what the camera never saw grey, by the column `class`.
QgisStyle landmark_style(const char* label);

/// The style as text.
std::string qml_text(const QgisStyle& style);

}  // namespace orchard::io

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::io {

/// How QGIS draws one kind of features; colours are "red,green,blue".
struct QgisSymbol {
  const char* value;   ///< value of the style's field; "" if there is one kind
  const char* legend;  ///< legend text
  const char* shape;   ///< marker: circle, square, diamond, cross_fill ...; line: solid, dash;
                       ///< area: solid
  const char* colour;
  double size_mm;  ///< marker size, line width, or border width of an area
};

/// Style of a layer in QGIS 3 (QML): points, lines or areas by kind, and a label.
struct QgisStyle {
  bool is_line = false;
  bool is_area = false;
  const char* field = "";  ///< field or expression that distinguishes the kinds; "": one kind
  std::vector<QgisSymbol> symbols;
  const char* label = "";  ///< expression; "": none
  double label_size_pt = 7.0;
  const char* choice_field = "";     ///< column that is filled by choosing from a list; "": none
  std::vector<const char*> choices;  ///< the values of that list
};

/// Style by a column or expression that gives tree, trunk, object or unseen: trees in rows green,
/// other trunks pale green, objects red, landmarks never in the camera's view grey.
QgisStyle landmark_style(const char* label, const char* kind);

/// Returns the style as QML.
std::string qml_text(const QgisStyle& style);

}  // namespace orchard::io

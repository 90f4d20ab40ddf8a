// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/qgis_style.hpp"

#include "text/encoded_text.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

constexpr char kTreeColour[] = "46,125,50", kTrunkColour[] = "190,215,170",
               kObjectColour[] = "198,40,40";
constexpr char kUnseenColour[] = "140,140,140";

/// Text as an escaped XML attribute.
std::string quoted(const std::string& text) { return "\"" + markup_text(text) + "\""; }

std::string property(const char* name, const std::string& value) {
  return "    <prop k=" + quoted(name) + " v=" + quoted(value) + "/>\n";
}

std::string symbol_text(const QgisStyle& style, std::size_t i) {
  const QgisSymbol& symbol = style.symbols[i];
  const std::string colour = std::string(symbol.colour) + ",255";
  std::string text = "   <symbol name=" + quoted(std::to_string(i)) + " type=" +
                     quoted(style.is_area   ? "fill"
                            : style.is_line ? "line"
                                            : "marker") +
                     " alpha=\"1\" clip_to_extent=\"1\">\n    <layer class=" +
                     quoted(style.is_area   ? "SimpleFill"
                            : style.is_line ? "SimpleLine"
                                            : "SimpleMarker") +
                     " enabled=\"1\" locked=\"0\" pass=\"0\">\n";
  if (style.is_area) {
    text += property("color", std::string(symbol.colour) + ",90") +
            property("style", symbol.shape) + property("outline_color", colour) +
            property("outline_width", fixed_text(symbol.size_mm, 2)) +
            property("outline_width_unit", "MM");
  } else if (style.is_line) {
    text += property("line_color", colour) + property("line_style", symbol.shape) +
            property("line_width", fixed_text(symbol.size_mm, 2)) +
            property("line_width_unit", "MM");
  } else {
    text += property("name", symbol.shape) + property("color", colour) +
            property("outline_color", "60,60,60,255") + property("outline_width", "0.15") +
            property("size", fixed_text(symbol.size_mm, 2)) + property("size_unit", "MM");
  }
  return text + "    </layer>\n   </symbol>\n";
}

std::string labels_text(const QgisStyle& style) {
  // Values of QGIS's placement: 0 is around a point, 2 along a line.
  return "  <labeling type=\"simple\">\n   <settings calloutType=\"simple\">\n    <text-style "
         "fieldName=" +
         quoted(style.label) +
         " isExpression=\"1\" fontSize=" + quoted(fixed_text(style.label_size_pt, 1)) +
         " fontSizeUnit=\"Point\" textColor=\"40,40,40,255\" fontFamily=\"Sans Serif\">\n"
         "     <text-buffer bufferDraw=\"1\" bufferSize=\"0.6\" bufferSizeUnits=\"MM\" "
         "bufferColor=\"255,255,255,255\"/>\n    </text-style>\n    <placement placement=\"" +
         (style.is_line ? "2" : "0") +
         "\" dist=\"0.8\" distUnits=\"MM\" priority=\"5\"/>\n    <rendering drawLabels=\"1\" "
         "obstacle=\"1\" displayAll=\"0\"/>\n   </settings>\n  </labeling>\n";
}

/// A list to choose from where QGIS and QField would have a value typed.
std::string choices_text(const QgisStyle& style) {
  std::string text = "  <fieldConfiguration>\n   <field name=" + quoted(style.choice_field) +
                     ">\n    <editWidget type=\"ValueMap\">\n     <config>\n      <Option "
                     "type=\"Map\">\n       <Option name=\"map\" type=\"List\">\n";
  for (const char* choice : style.choices) {
    text += "        <Option type=\"Map\"><Option name=" + quoted(choice) +
            " type=\"QString\" value=" + quoted(choice) + "/></Option>\n";
  }
  return text +
         "       </Option>\n      </Option>\n     </config>\n    </editWidget>\n   "
         "</field>\n  </fieldConfiguration>\n";
}

}  // namespace

QgisStyle landmark_style(const char* label, const char* kind) {
  QgisStyle style;
  style.field = kind;
  style.symbols = {
      {"tree", "tree in a row", "circle", kTreeColour, 2.4},
      {"trunk", "trunk in no row", "circle", kTrunkColour, 2.0},
      {"object", "object", "square", kObjectColour, 2.0},
      {"unseen", "not seen by the camera, or perhaps the ground", "diamond", kUnseenColour, 2.0}};
  style.label = label;
  style.choice_field = "class";
  style.choices = {"tree", "object", "unseen"};
  return style;
}

std::string qml_text(const QgisStyle& style) {
  const bool is_one = style.field[0] == '\0';
  const bool has_label = style.label[0] != '\0';
  const bool has_choice = style.choice_field[0] != '\0';
  std::string text =
      "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n<qgis version=\"3.22\" "
      "styleCategories=\"Symbology|Labeling" +
      std::string(has_choice ? "|Forms" : "") +
      "\" labelsEnabled=" + (has_label ? "\"1\"" : "\"0\"") + ">\n <renderer-v2 type=" +
      (is_one ? "\"singleSymbol\"" : "\"categorizedSymbol\" attr=" + quoted(style.field)) +
      " symbollevels=\"0\" forceraster=\"0\" enableorderby=\"0\">\n";
  if (!is_one) {
    text += "  <categories>\n";
    for (std::size_t i = 0; i < style.symbols.size(); ++i) {
      text += "   <category render=\"true\" symbol=" + quoted(std::to_string(i)) +
              " value=" + quoted(style.symbols[i].value) +
              " label=" + quoted(style.symbols[i].legend) + "/>\n";
    }
    text += "  </categories>\n";
  }
  text += "  <symbols>\n";
  for (std::size_t i = 0; i < style.symbols.size(); ++i) text += symbol_text(style, i);
  text += "  </symbols>\n </renderer-v2>\n";
  if (has_label) text += labels_text(style);
  if (has_choice) text += choices_text(style);
  return text + "</qgis>\n";
}

}  // namespace orchard::io

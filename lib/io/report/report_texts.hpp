// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::io {

/// All texts of a grower's report in one language; {} are placeholders. A new language is one more
/// argument of of().
struct ReportTexts {
  explicit ReportTexts(int language_number) : number(language_number) {}

  const char* of(const char* en, const char* es) const { return number == 0 ? en : es; }

  int number;  ///< 0 English, 1 Spanish
  const char* language = of("en", "es");
  /// in texts; files have a point in every language
  char decimal_point = *of(".", ",");
  /// {}: the map
  const char* title = of("Orchard report: {}", "Informe del huerto: {}");
  /// {}: the day, {}: the program's version
  const char* subtitle =
      of("Driven on {}. Orchard Mapper {}.", "Recorrido el {}. Orchard Mapper {}.");
  const char* unknown_day = of("an unknown day", "día desconocido");
  // What was counted.
  const char* counts = of("Contents of the block", "Qué hay en la parcela");
  const char* trees = of("Trees in rows: {}; rows: {}.", "Árboles en filas: {}; filas: {}.");
  const char* trunks =
      of("Trunks: {}. The map has no rows.", "Troncos: {}. El mapa no tiene filas.");
  const char* other_trunks =
      of("Other trunks, in no row: {}, with {} cm² of cross-sectional area. They may be bushes, "
         "posts, parts of a hedge or trees that stand alone, and are in no sum of this report.",
         "Otros troncos, sin fila: {}, con {} cm² de sección. Pueden ser matas, postes, partes de "
         "un seto o árboles sueltos, y no entran en ninguna suma de este informe.");
  const char* gaps = of("Empty places between the trees of the rows: {}.",
                        "Marras (puestos vacíos) entre los árboles de las filas: {}.");
  const char* objects =
      of("Other objects, such as posts and crates: {}.", "Otros objetos, como postes y cajas: {}.");
  const char* area =
      of("Trunk cross-sectional area: {} cm² in all, {} cm² per trunk on average.",
         "Área de la sección transversal del tronco: {} cm² en total, {} cm² por tronco de media.");
  const char* area_note =
      of("Trunk cross-sectional area (TCSA) is the area of a cut through the trunk at the height "
         "of the scanner. It grows with the tree and is used to compare yield and vigour.",
         "El área de la sección transversal del tronco (ASTT) es la del corte que haría una sierra "
         "a través del tronco a la altura del escáner. Crece con el árbol, y con ella se comparan "
         "la cosecha y el vigor.");
  // The block's picture.
  const char* picture = of("The block", "La parcela");
  /// {}: how many things the map has, {}: how many a page can show
  const char* no_picture = of(
      "No picture: of {} trees and other things, more than {} would hide each other on one page. "
      "map.html and map.gpkg of the map show them.",
      "Sin dibujo: de {} árboles y otras cosas, más de {} se taparían en una página. Los muestran "
      "map.html y map.gpkg del mapa.");
  const char* legend_tree = of("tree", "árbol");
  const char* legend_other = of("other trunk", "otro tronco");
  const char* legend_gap = of("empty place", "marra");
  const char* legend_object = of("other object", "otro objeto");
  const char* row_short = of("R", "F");
  // Rows.
  const char* rows = of("Row by row", "Fila por fila");
  const char* column_row = of("row", "fila");
  const char* column_trees = of("trees", "árboles");
  const char* column_gaps = of("empty", "marras");
  const char* column_gap_positions =
      of("empty places (number in the row)", "marras (número en la fila)");
  const char* column_diameter = of("diameter, cm", "diámetro, cm");
  const char* column_area = of("TCSA, cm²", "ASTT, cm²");
  const char* column_area_error = of("± cm²", "± cm²");
  /// {}: rows and the number that each begins with
  const char* late_rows =
      of("Rows whose first places are empty: {}. Their numbers are counted from where the rows "
         "around them, or the plan, begin.",
         "Filas con los primeros puestos vacíos: {}. Sus números se cuentan desde donde empiezan "
         "las filas de alrededor, o el plano.");
  /// {}: the row, {}: a number
  const char* late_row = of("{} (begins at {})", "{} (empieza en {})");
  const char* total = of("all", "total");
  // Slopes.
  const char* slopes = of("How steep the rows are", "Pendiente de las filas");
  const char* column_slope = of("slope, %", "pendiente, %");
  const char* column_slope_error = of("± %", "± %");
  const char* column_rise = of("rise, m", "desnivel, m");
  const char* slopes_note =
      of("From the first tree of a row to its last; below zero, the row goes down.",
         "Del primer árbol de la fila al último; con signo menos, la fila baja.");
  // Diameters.
  const char* diameters = of("Trunk diameters", "Diámetro de los troncos");
  const char* diameter_axis = of("trunk diameter (cm)", "diámetro del tronco (cm)");
  const char* trees_axis = of("trees", "árboles");
  const char* diameters_none =
      of("No trunk diameter is known.", "No se conoce el diámetro de ningún tronco.");
  // Gaps.
  const char* gap_places = of("Empty places", "Marras");
  const char* gap_none = of("No place is empty.", "No hay ninguna marra.");
  const char* column_place = of("x; y (m)", "x; y (m)");
  /// number along the row
  const char* column_position = of("number", "número");
  const char* column_geodetic = of("latitude, longitude", "latitud, longitud");
  const char* gap_note =
      of("An empty place is a gap between two neighbours in a row that is wide enough for a tree.",
         "Una marra es un puesto vacío: entre dos árboles vecinos queda sitio para otros.");
  // Changes.
  const char* changes = of("What has changed", "Qué ha cambiado");
  /// {}: the earlier map, {}: its day
  const char* changes_since = of("Compared with {} of {}.", "Comparado con {} del {}.");
  const char* column_change = of("change", "cambio");
  const char* column_count = of("trees", "árboles");
  const char* missing = of("gone", "ya no están");
  const char* new_trees = of("new", "nuevos");
  const char* moved = of("moved", "en otro sitio");
  const char* grown = of("thicker", "más gruesos");
  const char* thinner = of("thinner, or another tree", "más delgados, u otro árbol");
  const char* unchanged = of("as before", "como antes");
  const char* not_compared =
      of("unknown: not observed by both drives", "no se sabe: no los vieron los dos recorridos");
  const char* growth = of("Growth", "Crecimiento");
  const char* growth_all =
      of("Diameters have changed by {} mm ± {} mm on average. The cross-sectional area of the {} "
         "trees measured both times has changed by {} cm².",
         "Los diámetros han cambiado {} mm ± {} mm de media. El área de la sección de los {} "
         "árboles medidos las dos veces ha cambiado {} cm².");
  const char* column_growth = of("growth, cm²", "crecimiento, cm²");
  const char* column_growth_percent = of("growth, %", "crecimiento, %");
  const char* column_pairs = of("measured twice", "medidos dos veces");
  // The grower's plan.
  const char* plan = of("Against the plan", "Frente al plano");
  const char* plan_of = of("The plan is {}.", "El plano es {}.");
  const char* plan_column_row = of("row of the plan", "fila del plano");
  const char* as_planned = of("as planned", "según plano");
  const char* out_of_place = of("out of place", "fuera de sitio");
  const char* plan_missing = of("missing", "faltan");
  const char* plan_not_seen = of("not seen", "no vistos");
  const char* extra = of("extra", "de más");
  const char* shifted = of("shifted as a whole", "fila desplazada entera");
  // What was not seen.
  const char* not_seen = of("What was not observed, and why", "Qué no se vio, y por qué");
  const char* unseen = of(
      "Never in the view of the camera: {}. It is not known whether they are trees, and they are "
      "not counted.",
      "Nunca a la vista de la cámara: {}. No se sabe si son árboles, y no se cuentan.");
  const char* unclassified =
      of("Known neither as a trunk nor as another object: {}. They are not counted.",
         "No se sabe si son troncos u otros objetos: {}. No se cuentan.");
  const char* all_seen = of("Everything in the map was in the view of the camera.",
                            "Todo lo que está en el mapa estuvo a la vista de la cámara.");
  const char* no_camera = of("The map was made without a camera: the laser alone has seen it.",
                             "El mapa se hizo sin cámara: solo lo vio el láser.");
  const char* without_pictures =
      of("For {} s there were no pictures; objects first observed in that time: {}.",
         "Durante {} s no hubo imágenes; objetos que se encontraron entonces por primera vez: {}.");
  const char* without_fixes = of("For {} s there was no satellite position.",
                                 "Durante {} s no hubo posición por satélite.");
  const char* changes_not_seen = of("Trees of the earlier map out of view in this drive: {}.",
                                    "Árboles del mapa anterior que esta vez no se vieron: {}.");
  const char* warnings = of("Warnings of the program while mapping (in English): {}",
                            "Mientras se hacía el mapa, el programa avisó (en inglés): {}");
  // How sure.
  const char* how_sure = of("Uncertainty", "Con qué seguridad se sabe");
  const char* sure =
      of("Sure trees (95 % or more): {}; likely ones (80 % or more): {}; unsure ones: {}.",
         "Árboles seguros (95 % o más): {}; probables (80 % o más): {}; dudosos: {}.");
  const char* places =
      of("By the scatter of its observations, a tree's position among its neighbours is known to "
         "about {} cm (half of the trees better).",
         "Según la dispersión de sus observaciones, el sitio de un árbol entre sus vecinos se "
         "conoce con unos {} cm de error (la mitad de los árboles, mejor).");
  const char* widths =
      of("Likewise, the diameter of a trunk is known to about {} mm (half of them better).",
         "También según su dispersión, el diámetro de un tronco se conoce con unos {} mm de error "
         "(la mitad, mejor).");
  const char* width_bias =
      of("The ± in these tables is the scatter alone. What is common to all comes on top: of "
         "diameters the error of the scanner's calibration, which cancels between two drives of "
         "one robot; of positions that of the robot's path.",
         "El ± de estas tablas es solo el de la dispersión. Se le añade lo que es común a todos: "
         "en los diámetros, el error de calibración del escáner, que se anula entre dos recorridos "
         "del mismo robot; en los sitios, el del recorrido del robot.");
};

/// Texts for "en" or "es"; null for another language.
const ReportTexts* find_report_texts(const std::string& language);

}  // namespace orchard::io

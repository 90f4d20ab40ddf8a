// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/task_file.hpp"

#include <algorithm>
#include <set>

#include "io/file_error.hpp"
#include "io/gis/qgis_style.hpp"
#include "io/gis/survey_file.hpp"
#include "io/gis/vector_file.hpp"
#include "text/encoded_text.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

constexpr char kTasks[] = "tasks", kOpen[] = "open", kDone[] = "done";
constexpr std::size_t kTextMax = 1000;  ///< derived: of a word or a note, more than a line holds

struct TextColumn {
  const char* name;
  std::string mapping::Task::*text;
};
constexpr TextColumn kTexts[] = {
    {"what", &mapping::Task::what}, {"row", &mapping::Task::row},
    {"why", &mapping::Task::why},   {"since", &mapping::Task::since},
    {"seen", &mapping::Task::seen}, {"note", &mapping::Task::note},
};

std::string label_of(const mapping::Task& task) {
  const std::string place = task.tree > 0 ? " " + task.row + "/" + std::to_string(task.tree) : "";
  return task.what + place + (task.is_done ? " (done)" : "");
}

GeoValue value_of(const std::string& text) { return text.empty() ? GeoValue() : GeoValue(text); }

/// The number of a field, from 1; 0: empty.
std::int32_t number_of(const std::string& text, const std::string& at, const char* name) {
  const auto number = whole_number(text);
  if (text.empty() || (number && *number >= 0)) return text.empty() ? 0 : *number;
  throw FileError(at + ": " + name + " " + printable_text(text.substr(0, 40)) +
                  " must be a whole number, or empty");
}

bool is_done(std::string state, const std::string& at) {
  std::transform(state.begin(), state.end(), state.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (state == kDone || state == kOpen || state.empty()) return state == kDone;
  throw FileError(at + ": state \"" + printable_text(state.substr(0, 40)) +
                  "\" must be open or done");
}

}  // namespace

void write_tasks(const std::vector<mapping::Task>& tasks, LayerFile& file) {
  QgisStyle style;
  style.field = "state";
  style.symbols = {{kOpen, kOpen, "circle", "239,108,0", 3.0},
                   {kDone, kDone, "circle", "140,140,140", 2.0}};
  style.label = "\"label\"";
  style.choice_field = "state";
  style.choices = {kOpen, kDone};
  GeoLayer layer{kTasks,
                 GeoGeometry::kPoint,
                 "What is to do where; tick by state: open or done",
                 {{"task", GeoType::kInteger}, {"state", GeoType::kText}},
                 qml_text(style)};
  for (const TextColumn& column : kTexts) layer.fields.push_back({column.name, GeoType::kText});
  layer.fields.push_back({"tree", GeoType::kInteger});
  layer.fields.push_back({"label", GeoType::kText});
  file.begin_layer(layer);
  for (const mapping::Task& task : tasks) {
    std::vector<GeoValue> values{std::int64_t{task.number},
                                 std::string(task.is_done ? kDone : kOpen)};
    for (const TextColumn& column : kTexts) values.push_back(value_of(task.*column.text));
    values.push_back(task.tree > 0 ? GeoValue(std::int64_t{task.tree}) : GeoValue());
    values.push_back(label_of(task));
    file.add(values, {task.p_map});
  }
}

std::vector<mapping::Task> read_tasks(const std::string& path,
                                      const std::optional<geometry::Georeference>& georeference) {
  VectorFileOptions options;
  options.drivers = {"GeoJSON", "GPKG"};
  options.formats = "a GeoJSON or a GeoPackage of `orchard tasks`";
  const std::string end = ".gpkg";  // QGIS keeps tables of its own in it
  if (path.size() > end.size() && path.compare(path.size() - end.size(), end.size(), end) == 0) {
    options.layers = {kTasks};
  }
  const VectorFile file = read_vector_file(path, options);
  if (file.layers.empty()) throw FileError(path + " has no layer tasks; give the ticked file");
  const VectorLayer& layer = file.layers.front();
  for (const char* name : {"task", "state", "what"}) {
    if (!layer.has(name))
      throw FileError(path + " has no column " + name + "; give a file of `orchard tasks`");
  }
  require_frame_of(layer, path, georeference);
  std::vector<mapping::Task> tasks;
  std::set<std::int32_t> numbers;
  for (const VectorFeature& feature : layer.features) {
    const std::string at = path + ": feature " + std::to_string(feature.number);
    mapping::Task& task = tasks.emplace_back();
    task.number = number_of(layer.text(feature, "task"), at, "task");
    if (task.number > 0 && !numbers.insert(task.number).second) {
      throw FileError(at + ": task " + std::to_string(task.number) +
                      " is there twice; empty the number of the copy");
    }
    task.is_done = is_done(layer.text(feature, "state"), at);
    task.tree = number_of(layer.text(feature, "tree"), at, "tree");
    for (const TextColumn& column : kTexts) {
      std::string& text = task.*column.text = printable_text(layer.text(feature, column.name));
      if (text.size() > kTextMax) throw FileError(at + ": " + column.name + " is too long");
    }
    task.p_map = place_in_map(feature, at, georeference);
    if (task.p_map.norm() > kFarthestInBlock_m) {
      throw FileError(at + " is " + fixed_text(1e-3 * task.p_map.norm(), 0) +
                      " km from the map; give the tasks of this block");
    }
  }
  return tasks;
}

}  // namespace orchard::io

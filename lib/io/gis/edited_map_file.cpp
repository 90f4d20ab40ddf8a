// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/edited_map_file.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "detection/detection.hpp"
#include "io/file_error.hpp"
#include "io/gis/map_layers.hpp"
#include "io/gis/vector_file.hpp"
#include "io/sane_limits.hpp"
#include "text/encoded_text.hpp"
#include "text/number_text.hpp"
#include "text/parse_number.hpp"

namespace orchard::io {
namespace {

using Eigen::Vector2d;

constexpr double kNumberMax = 2147483646.0;

/// A feature and its layer.
struct Entry {
  const VectorLayer& layer;
  const VectorFeature& feature;

  std::string text(std::string_view name) const { return layer.text(feature, name); }
};

class EditedMapReader {
 public:
  EditedMapReader(const std::string& path,
                  const std::optional<geometry::Georeference>& georeference)
      : path_(path), georeference_(georeference) {
    VectorFileOptions options;
    options.drivers = {"GPKG"};
    options.formats = "a GeoPackage";
    options.layers = {"landmarks", "rows"};
    file_ = read_vector_file(path, options);
  }

  EditedMapFile read() {
    if (const auto number = file_.metadata.find(kCorrectionsMetadata);
        number != file_.metadata.end()) {
      const auto num_corrections = whole_number(number->second.c_str());
      if (!num_corrections || *num_corrections < 0) {
        throw FileError(path_ + ": its number of corrections is invalid; export the map again");
      }
      result_.num_corrections = *num_corrections;
    }
    const VectorLayer* landmarks = layer("landmarks");
    if (landmarks == nullptr) {
      throw FileError(path_ + " has no layer `landmarks`; give the edited GeoPackage of a map");
    }
    read_landmarks(*landmarks);
    if (const VectorLayer* rows = layer("rows")) read_rows(*rows);
    return std::move(result_);
  }

 private:
  const VectorLayer* layer(std::string_view name) const {
    for (const VectorLayer& layer : file_.layers) {
      if (layer.name == name) return &layer;
    }
    return nullptr;
  }

  void read_landmarks(const VectorLayer& layer) {
    for (const char* name : {"id", "class"}) {
      if (!layer.has(name)) {
        throw FileError(path_ + ": layer landmarks has no column " + name +
                        "; give the edited GeoPackage of a map");
      }
    }
    require_frame_of(layer, path_, georeference_);
    for (const VectorFeature& feature : layer.features) {
      const Entry entry{layer, feature};
      at_ = path_ + ": feature " + std::to_string(feature.number) + " of landmarks";
      mapping::EditedLandmark l;
      l.id = number(entry, "id");
      l.p_map = place_in_map(feature, at_, georeference_);
      l.label = label(entry, l.id == 0);
      l.width_m = real(entry, "width_m");
      if (l.width_m > kMaxWidth_m) throw FileError(at_ + ": width_m is out of range");
      l.row = number(entry, "row");
      l.position = number(entry, "position");
      l.note = one_line(entry.text("note"), l.id);
      result_.map.landmarks.push_back(std::move(l));
    }
  }

  void read_rows(const VectorLayer& layer) {
    for (const VectorFeature& feature : layer.features) {
      const Entry entry{layer, feature};
      at_ = path_ + ": feature " + std::to_string(feature.number) + " of rows";
      const std::int32_t row = number(entry, "row");
      if (row > 0) result_.map.row_names[row] = entry.text("label");
    }
  }

  /// A newly drawn feature without class is a tree.
  detection::Label label(const Entry& entry, bool is_new) const {
    const std::string word = entry.text("class");
    if (word.empty() && is_new) return detection::Label::kTree;
    for (const auto label :
         {detection::Label::kTree, detection::Label::kObject, detection::Label::kUnseen}) {
      if (word == label_text(label)) return label;
    }
    throw FileError(at_ + ": class \"" + printable_text(word.substr(0, 40)) +
                    "\" must be tree, object or unseen");
  }

  double real(const Entry& entry, const char* name) const {
    const std::string text = entry.text(name);
    if (text.empty()) return 0.0;
    const auto value = parse_number<double>(text);
    if (value && *value >= 0.0 && *value <= kNumberMax) return *value;
    throw FileError(at_ + ": " + name + " is out of range");
  }
  std::int32_t number(const Entry& entry, const char* name) const {
    const double value = real(entry, name);
    if (value != std::floor(value)) throw FileError(at_ + ": " + name + " must be a whole number");
    return static_cast<std::int32_t>(value);
  }

  /// Joins a note of several lines, because a correction is a single line.
  std::string one_line(const std::string& note, std::int32_t id) {
    std::string line;
    bool is_broken = false;
    for (const char c : note) {
      const bool is_break = c == '\n' || c == '\r';
      is_broken |= is_break;
      if (!is_break) {
        line += c;
      } else if (!line.empty() && line.back() != ' ') {
        line += ' ';
      }
    }
    while (is_broken && !line.empty() && line.back() == ' ') line.pop_back();
    if (is_broken) {
      result_.left_out.push_back("line breaks in the note of " +
                                 (id == 0 ? "a new landmark" : "landmark " + std::to_string(id)));
    }
    return line;
  }

  const std::string& path_;
  const std::optional<geometry::Georeference>& georeference_;
  VectorFile file_;
  std::string at_;
  EditedMapFile result_;
};

}  // namespace

EditedMapFile read_edited_map(const std::string& path,
                              const std::optional<geometry::Georeference>& georeference) {
  return EditedMapReader(path, georeference).read();
}

}  // namespace orchard::io

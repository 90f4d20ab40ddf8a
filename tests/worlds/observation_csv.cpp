// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/observation_csv.hpp"

#include <map>
#include <set>

#include "geometry/angles.hpp"
#include "io/atomic_file.hpp"
#include "io/csv.hpp"
#include "io/file_error.hpp"
#include "io/sane_limits.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using detection::Label;
using simulation::TrueObservation;

constexpr std::int64_t kMaxObject = 100000000;
constexpr std::int64_t kMaxBeamsOnThing = 1000000;

Label read_class(const CsvReader& csv, std::size_t field) {
  if (csv.text(field) == "tree") return Label::kTree;
  if (csv.text(field) == "object") return Label::kObject;
  csv.fail(field, "must be tree or object");
}

std::vector<TrueObservation> read_observations(CsvReader csv) {
  csv.expect_columns({"utime_us", "object", "class", "x_m", "y_m", "width_m", "range_m",
                      "bearing_rad", "num_beams", "hidden_fraction", "in_picture"});
  std::vector<TrueObservation> observations;
  std::set<int> in_scan;
  std::map<int, Label> labels;
  while (csv.next()) {
    TrueObservation o;
    o.utime = csv.integer(0);
    if (!observations.empty() && o.utime < observations.back().utime) {
      csv.fail(0, "the time must not decrease from line to line");
    }
    if (observations.empty() || o.utime != observations.back().utime) in_scan.clear();
    o.object = static_cast<int>(csv.integer_in(1, 0, kMaxObject));
    if (!in_scan.insert(o.object).second) csv.fail(1, "occurs twice in one scan");
    o.label = read_class(csv, 2);
    if (labels.emplace(o.object, o.label).first->second != o.label) {
      csv.fail(2, "differs from the class of this object in an earlier line");
    }
    o.x_m = csv.number_in(3, -kMaxCoordinate_m, kMaxCoordinate_m);
    o.y_m = csv.number_in(4, -kMaxCoordinate_m, kMaxCoordinate_m);
    o.width_m = csv.number_in(5, 0.0, kMaxWidth_m);
    o.range_m = csv.number_in(6, -kMaxWidth_m, kMaxRange_m);
    o.bearing_rad = csv.number_in(7, -2.0 * geometry::kPi, 2.0 * geometry::kPi);
    o.num_beams = static_cast<int>(csv.integer_in(8, 0, kMaxBeamsOnThing));
    o.hidden_fraction = csv.number_in(9, 0.0, 1.0);
    o.in_picture = csv.integer_in(10, 0, 1) == 1;
    observations.push_back(o);
  }
  return observations;
}

}  // namespace

std::vector<TrueObservation> read_observation_csv(const std::string& path) {
  return read_observations(CsvReader::open(path));
}

void write_observation_csv(const std::string& path,
                           const std::vector<TrueObservation>& observations) {
  std::string text =
      "utime_us,object,class,x_m,y_m,width_m,range_m,bearing_rad,num_beams,hidden_fraction,"
      "in_picture\n";
  for (const TrueObservation& o : observations) {
    if (o.label == Label::kUnseen)
      throw FileError(path + ": an object of the truth must not be unseen");
    text += std::to_string(o.utime) + "," + std::to_string(o.object) +
            (o.label == Label::kTree ? ",tree," : ",object,") + fixed_text(o.x_m, 4) + "," +
            fixed_text(o.y_m, 4) + "," + fixed_text(o.width_m, 4) + "," + fixed_text(o.range_m, 4) +
            "," + fixed_text(o.bearing_rad, 5) + "," + std::to_string(o.num_beams) + "," +
            fixed_text(o.hidden_fraction, 3) + "," + (o.in_picture ? "1" : "0") + "\n";
  }
  write_file_atomically(path, text);
}

}  // namespace orchard::io

// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/survey_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <GeographicLib/Geodesic.hpp>
#include <string>

#include "io/file_error.hpp"
#include "io/map/map_csv.hpp"
#include "unit/io/test_folder.hpp"

namespace orchard::io {
namespace {

using ::testing::HasSubstr;

class SurveyFile : public ::testing::Test {
 protected:
  StoredSurvey survey(const std::string& name, const std::string& text) const {
    return read_survey(folder_.file(name, text), {});
  }
  std::string refusal(const std::string& name, const std::string& text) const {
    return refusal_of([&] { survey(name, text); });
  }

  TestFolder folder_;
};

geometry::Georeference datum_at(double latitude_deg, double longitude_deg) {
  geometry::Georeference datum;
  datum.latitude_deg = latitude_deg;
  datum.longitude_deg = longitude_deg;
  return datum;
}

std::string refusal_about(const StoredSurvey& survey, const geometry::Georeference& datum) {
  return refusal_of([&] { survey_about(survey, datum); });
}

/// A GeoJSON of three points on the earth, the first at longitude, latitude.
std::string geojson(double longitude_deg, double latitude_deg) {
  std::string text = "{\"type\":\"FeatureCollection\",\"features\":[";
  for (int i = 0; i < 3; ++i) {
    text += std::string(i == 0 ? "" : ",") +
            "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"Point\","
            "\"coordinates\":[" +
            std::to_string(longitude_deg + 1e-5 * i) + "," + std::to_string(latitude_deg) + "]}}";
  }
  return text + "]}";
}

TEST_F(SurveyFile, KeepsEveryPointAlsoInNoRow) {
  const StoredSurvey s = survey("s.csv", "name,x_m,y_m\npost,1.5,-2\nvine,100,3\nvine,7,7\n");
  ASSERT_EQ(s.points.size(), 3u);
  EXPECT_EQ(s.points[1].p_m, Eigen::Vector2d(100.0, 3.0));
  EXPECT_EQ(s.points[1].sd_m, 0.0);
  EXPECT_FALSE(s.georeference);
  EXPECT_EQ(survey_about(s, datum_at(50, 5)).points[1].p_m, Eigen::Vector2d(100.0, 3.0));
}

TEST_F(SurveyFile, TakesRowNumberAndAccuracyWhereTheyAre) {
  const StoredSurvey s = survey("s.csv", "row,tree,x_m,y_m,accuracy_m\nB1,3,1,2,0.02\nB1,4,1,4,\n");
  EXPECT_EQ(s.points[0].row, "B1");
  EXPECT_EQ(s.points[0].tree, "3");
  EXPECT_EQ(s.points[0].sd_m, 0.02);
  EXPECT_EQ(s.points[1].sd_m, 0.0);
  EXPECT_EQ(survey_csv(s),
            "x_m,y_m,sd_m,row,tree\n1.0000,2.0000,0.0200,B1,3\n1.0000,4.0000,,B1,4\n");
}

TEST_F(SurveyFile, DegreesBecomeMetresFromTheDatum) {
  // the truth by the geodesic on the ellipsoid: 30 m east of the datum
  double latitude_deg = 0.0, longitude_deg = 0.0;
  GeographicLib::Geodesic::WGS84().Direct(53.268, -0.5245, 90.0, 30.0, latitude_deg, longitude_deg);
  const StoredSurvey s = survey_about(survey("s.geojson", geojson(longitude_deg, latitude_deg)),
                                      datum_at(53.268, -0.5245));
  EXPECT_NEAR(s.points[0].p_m.x(), 30.0, 0.05);  // six decimals of degrees
  EXPECT_NEAR(s.points[0].p_m.y(), 0.0, 0.06);
  EXPECT_EQ(s.georeference->latitude_deg, 53.268);
}

TEST_F(SurveyFile, ExchangedAxesAreNamedWhereADatumTells) {
  EXPECT_THAT(refusal("swapped.geojson", geojson(53.268, -99.5)), HasSubstr("not on the earth"));
  const StoredSurvey swapped = survey("swapped.geojson", geojson(53.268, -0.5245));
  EXPECT_THAT(refusal_about(swapped, datum_at(53.268, -0.5245)),
              HasSubstr("latitudes and longitudes are exchanged"));
  const std::string far = refusal_about(swapped, datum_at(41.0, 0.6));
  EXPECT_THAT(far, HasSubstr("km from the datum 41.0000, 0.6000"));
  EXPECT_THAT(far, ::testing::Not(HasSubstr("exchanged")));
}

TEST_F(SurveyFile, SaysWhatIsWrong) {
  EXPECT_THAT(refusal("s.csv", "x_m,y_m\n1,2\n3,nan\n"), HasSubstr("feature 2"));
  EXPECT_THAT(refusal("s.csv", "x_m,y_m\n1,2\n3,inf\n"), HasSubstr("feature 2"));
  EXPECT_THAT(refusal("s.csv", "x_m,y_m\n1,2\n5,5\n1.001,2\n"),
              HasSubstr("features 1 and 3 are at the same place"));
  EXPECT_THAT(refusal("s.csv", "name,height\na,2\n"), HasSubstr("no columns with positions"));
  EXPECT_THAT(refusal("s.csv", "x_m,y_m\n"), HasSubstr("has no points"));
  EXPECT_THAT(refusal("s.csv", "x_m,y_m,sd_m\n1,2,-0.1\n"), HasSubstr("accuracy must be above 0"));
  EXPECT_THAT(refusal("s.csv", "x_m,y_m,sd_m\n1,2,nan\n"), HasSubstr("accuracy must be above 0"));
  EXPECT_THAT(refusal("s.csv", "easting,northing\n498518.9,375589.6\n498520,375589\n"),
              HasSubstr("--crs"));
  EXPECT_THAT(refusal("s.csv", "x_m,y_m\n1,2\n50000,2\n"), HasSubstr("km from the middle"));
  EXPECT_THAT(refusal("s.geojson", "{\"type\":\"LineString\",\"coordinates\":[[0.5,41],[0.6,41]]}"),
              HasSubstr("one point for each trunk or post"));
  EXPECT_THAT(refusal("s.geojson", "{\"type\":"), HasSubstr("is not a GeoPackage"));
}

TEST_F(SurveyFile, AMapOfOursIsNone) {
  EXPECT_TRUE(is_map(folder_.path()));
  EXPECT_TRUE(is_map(folder_ / "missing.csv"));
  EXPECT_TRUE(is_map(folder_.file("map.csv", "id,class,x_m,y_m,n,roc_mean\n")));
  EXPECT_TRUE(is_map(folder_.file("map.csv.gz", "\x1f\x8b and seven more bytes")));
  EXPECT_FALSE(is_map(folder_.file("survey.csv", "class,x_m,y_m,width_m\ntree,1,2,0.1\n")));
  EXPECT_FALSE(is_map(folder_.file("survey.geojson", geojson(1, 2))));
}

}  // namespace
}  // namespace orchard::io

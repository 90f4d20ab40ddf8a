// SPDX-License-Identifier: BSD-3-Clause
#include <cpl_minixml.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <set>
#include <string>

#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/map/map_folder.hpp"
#include "io/map/map_folder_lock.hpp"
#include "io/recording/truth_csv.hpp"
#include "unit/io/test_folder.hpp"

namespace orchard::io {
namespace {

using detection::Label;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

MapFolderContent make_content(int num_landmarks) {
  MapFolderContent content;
  for (int i = 0; i < num_landmarks; ++i) {
    mapping::Landmark l;
    l.id = i + 1;
    l.label = i % 7 == 3 ? Label::kObject : i % 11 == 5 ? Label::kUnseen : Label::kTree;
    l.x_m = 0.9 * (i % 25);
    const int line = i / 25;
    l.y_m = 3.0 * line - 0.00001;
    l.num_observations = 5 + i;
    l.roc_mean = 0.87;
    l.probability = 0.999;
    l.se_x_m = l.se_y_m = 0.005;
    l.width_m = 0.09;
    l.row = i % 2;
    l.position = i % 2;
    content.landmarks.push_back(l);
  }
  for (int i = 0; i < 100; ++i) {
    pose::PoseEstimate p;
    p.utime = 1000000 + 100000 * i;
    p.x_m = 0.2 * i;
    p.y_m = 1.5 + std::sin(0.1 * i);
    content.trajectory.push_back(p);
  }
  content.summary.source = "a.lcm";
  content.summary.counts = {{"SCAN", 100}};
  content.summary.warnings = {"bad \xFF name"};
  return content;
}

const char* const kFiles[] = {"map.csv",    "map.gpkg",    "map.svg",        "map.png",
                              "map.pdf",    "map.html",    "trajectory.csv", "trajectory.tum",
                              "graph.json", "summary.json"};

TEST(MapFolder, EqualContentGivesEqualBytes) {
  const TestFolder a, b;
  for (const int n : {0, 16, 500}) {
    write_map_folder(a.path(), make_content(n));
    write_map_folder(b / "made/for/it", make_content(n));
    for (const std::string file : kFiles) {
      EXPECT_EQ(read_bytes(a / file), read_bytes(b / ("made/for/it/" + file))) << file << " " << n;
      EXPECT_FALSE(read_bytes(a / file).empty());
    }
  }
  EXPECT_THAT(read_bytes(a / "map.svg"), HasSubstr("#glyph")) << "numbers";
  int num_files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(a.path())) {
    num_files += entry.exists() ? 1 : 0;
  }
  EXPECT_EQ(num_files, 10) << "no temporary stays";
}

TEST(MapCsv, HasItsFixedFormAndReadsBack) {
  const TestFolder folder;
  auto landmarks = make_content(8).landmarks;
  landmarks[0].width_sd_m = 0.0021;
  const std::string text = map_csv(landmarks);
  EXPECT_THAT(
      text,
      HasSubstr(
          "id,class,x_m,y_m,n,roc_mean,probability,se_x_m,se_y_m,width_m,row,"
          "position,width_sd_m,length_m,direction_deg,z_m,z_sd_m\n1,tree,0.0000,0.0000,5,0.8700,"
          "0.9990,0.0050,0.0050,0.0900,,,0.0021,,,,\n2,tree,0.9000,0.0000,6,"));
  write_bytes(folder / "map.csv", text);
  EXPECT_EQ(map_csv(read_map_csv(folder / "map.csv")), text);
  // the maps of earlier releases have no width_sd_m
  const auto old = read_map_csv(
      folder.file("old.csv",
                  "id,class,x_m,y_m,n,roc_mean,probability,se_x_m,se_y_m,width_m,row,position\n"
                  "7,tree,1,2,5,0.9,0.99,0.01,0.01,0.09,3,4\n"));
  EXPECT_EQ(old.at(0).position, 4);
  EXPECT_EQ(old.at(0).width_sd_m, 0.0);
  // a hedge
  landmarks[0].length_m = 12.5;
  landmarks[0].direction_rad = -0.5;
  const auto with_hedge = read_map_csv(folder.file("hedge.csv", map_csv(landmarks)));
  EXPECT_DOUBLE_EQ(with_hedge[0].length_m, 12.5);
  EXPECT_NEAR(with_hedge[0].direction_rad, -0.5, 1e-4);
  EXPECT_EQ(with_hedge[1].length_m, 0.0);
  // the height of the ground
  landmarks[0].z_m = -12.3456;
  landmarks[0].z_sd_m = 1e-7;  // stays known
  const std::string with_height = map_csv(landmarks);
  EXPECT_THAT(with_height, HasSubstr(",-12.3456,0.0001\n2,"));
  const auto high = read_map_csv(folder.file("high.csv", with_height));
  EXPECT_DOUBLE_EQ(high[0].z_m, -12.3456);
  EXPECT_EQ(high[1].z_sd_m, 0.0);
  EXPECT_EQ(map_csv(high), with_height);
  const std::string head = with_height.substr(0, with_height.find('\n') + 1);
  for (const char* heights : {"1.5,", ",0.1", "1.5,0", "1.5,-1", "nan,0.1"}) {
    const std::string line = "7,tree,1,2,5,0.9,0.99,0,0,0.1,,,,,," + std::string(heights) + "\n";
    EXPECT_THROW(read_map_csv(folder.file("bad.csv", head + line)), FileError) << heights;
  }
  EXPECT_THROW(read_map_csv(folder.file("twice.csv", text + text.substr(text.find('\n') + 1))),
               FileError);
  EXPECT_THROW(read_map_csv(folder.file("map.csv", "id,x\n1,2\n")), FileError);
}

/// A GeoPackage as GDAL reads it, which has not written it.
std::unique_ptr<GDALDataset> opened(const std::string& path) {
  GDALAllRegister();
  return std::unique_ptr<GDALDataset>(
      GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
}

TEST(MapGeopackage, OpensWithBothLayers) {
  const TestFolder folder;
  write_map_folder(folder.path(), make_content(20));
  const auto dataset = opened(folder / "map.gpkg");
  ASSERT_NE(dataset, nullptr);
  OGRLayer* landmarks = dataset->GetLayerByName("landmarks");
  ASSERT_NE(landmarks, nullptr);
  EXPECT_EQ(landmarks->GetFeatureCount(), 20);
  const std::unique_ptr<OGRFeature> second(landmarks->GetFeature(2));
  ASSERT_NE(second, nullptr);
  EXPECT_DOUBLE_EQ(second->GetGeometryRef()->toPoint()->getX(), 0.9);
  EXPECT_STREQ(second->GetFieldAsString("class"), "tree");
  ASSERT_NE(landmarks->GetSpatialRef(), nullptr);
  EXPECT_TRUE(landmarks->GetSpatialRef()->IsLocal());
  OGRLayer* path = dataset->GetLayerByName("path");
  ASSERT_NE(path, nullptr);
  EXPECT_EQ(path->GetFeatureCount(), 1);
}

TEST(MapGeopackage, APointIsAsHighAsItsGroundWhereThatIsKnown) {
  const TestFolder folder;
  MapFolderContent content = make_content(20);
  content.landmarks[1].z_m = 2.5;
  content.landmarks[1].z_sd_m = 0.05;
  geometry::Georeference georeference;
  georeference.latitude_deg = 48.0;
  georeference.longitude_deg = 11.0;
  georeference.altitude_m = 500.0;
  content.georeference = georeference;
  write_map_folder(folder.path(), content);
  const auto dataset = opened(folder / "map.gpkg");
  ASSERT_NE(dataset, nullptr);
  OGRLayer* landmarks = dataset->GetLayerByName("landmarks");
  const std::unique_ptr<OGRFeature> first(landmarks->GetFeature(1));
  const std::unique_ptr<OGRFeature> second(landmarks->GetFeature(2));
  EXPECT_FALSE(first->GetGeometryRef()->Is3D());
  EXPECT_FALSE(first->IsFieldSetAndNotNull(first->GetFieldIndex("z_m")));
  ASSERT_TRUE(second->GetGeometryRef()->Is3D());
  EXPECT_DOUBLE_EQ(second->GetGeometryRef()->toPoint()->getZ(), 502.5);  // above the ellipsoid
  EXPECT_DOUBLE_EQ(second->GetFieldAsDouble("z_m"), 2.5);
  EXPECT_DOUBLE_EQ(second->GetFieldAsDouble("z_sd_m"), 0.05);
}

TEST(MapGeopackage, AHedgeIsAnAreaAsLongAndAsWideAsItIs) {
  const TestFolder folder;
  MapFolderContent content = make_content(4);
  mapping::Landmark& hedge = content.landmarks[1];
  hedge.label = detection::Label::kObject;
  hedge.width_m = 0.8;
  hedge.length_m = 12.8;
  hedge.direction_rad = 0.5;
  write_map_folder(folder.path(), content);
  const auto dataset = opened(folder / "map.gpkg");
  ASSERT_NE(dataset, nullptr);
  OGRLayer* extents = dataset->GetLayerByName("extents");
  ASSERT_NE(extents, nullptr);
  bool is_there = false;
  for (const auto& area : *extents) {
    if (area->GetFieldAsInteger("id") != hedge.id) continue;
    is_there = true;
    ASSERT_EQ(wkbFlatten(area->GetGeometryRef()->getGeometryType()), wkbPolygon);
    const OGRPolygon& polygon = *area->GetGeometryRef()->toPolygon();
    EXPECT_TRUE(polygon.IsValid());
    // 12 m between the middles of its round ends
    EXPECT_NEAR(polygon.get_Area(), 12.0 * 0.8 + M_PI * 0.4 * 0.4, 0.01);
    OGRPoint middle;
    polygon.Centroid(&middle);
    EXPECT_NEAR(middle.getX(), hedge.x_m, 0.5e-4);  // of corners that are stored to 0.1 mm
    EXPECT_NEAR(middle.getY(), hedge.y_m, 0.5e-4);
    const OGRPoint inside(hedge.x_m + 6.3 * std::cos(0.5), hedge.y_m + 6.3 * std::sin(0.5));
    const OGRPoint beyond(hedge.x_m + 6.5 * std::cos(0.5), hedge.y_m + 6.5 * std::sin(0.5));
    EXPECT_TRUE(polygon.Contains(&inside));
    EXPECT_FALSE(polygon.Contains(&beyond));
    EXPECT_NEAR(area->GetFieldAsDouble("direction_deg"), 0.5 * 180.0 / M_PI, 1e-9);
  }
  EXPECT_TRUE(is_there);
}

TEST(MapGeopackage, HasTheTrunksMeasuresAndAStyleForEachLayer) {
  const TestFolder folder;
  write_map_folder(folder.path(), make_content(20));
  const auto dataset = opened(folder / "map.gpkg");
  ASSERT_NE(dataset, nullptr);
  OGRLayer* landmarks = dataset->GetLayerByName("landmarks");
  const std::unique_ptr<OGRFeature> tree(landmarks->GetFeature(2));
  EXPECT_DOUBLE_EQ(tree->GetFieldAsDouble("diameter_mm"), 90.0);
  EXPECT_NEAR(tree->GetFieldAsDouble("cross_section_cm2"), 63.617, 1e-3) << "pi 4.5 cm squared";
  EXPECT_STREQ(tree->GetFieldAsString("label"), "1/1");
  const std::unique_ptr<OGRFeature> object(landmarks->GetFeature(4));
  EXPECT_STREQ(object->GetFieldAsString("class"), "object");
  EXPECT_FALSE(object->IsFieldSetAndNotNull(object->GetFieldIndex("diameter_mm"))) << "no trunk";
  OGRLayer* styles = dataset->GetLayerByName("layer_styles");
  ASSERT_NE(styles, nullptr);
  EXPECT_EQ(styles->GetFeatureCount(), 8);
  for (const auto& row : *styles) {
    OGRLayer* layer = dataset->GetLayerByName(row->GetFieldAsString("f_table_name"));
    ASSERT_NE(layer, nullptr);
    EXPECT_STREQ(row->GetFieldAsString("f_geometry_column"), layer->GetGeometryColumn());
    EXPECT_STREQ(row->GetFieldAsString("f_table_schema"), "") << "QGIS looks for this";
    EXPECT_EQ(row->GetFieldAsInteger("useAsDefault"), 1);
    const std::unique_ptr<CPLXMLNode, void (*)(CPLXMLNode*)> qml(
        CPLParseXMLString(row->GetFieldAsString("styleQML")), CPLDestroyXMLNode);
    ASSERT_NE(qml, nullptr);
    CPLXMLNode* root = CPLGetXMLNode(qml.get(), "=qgis");
    ASSERT_NE(root, nullptr);
    EXPECT_NE(CPLGetXMLNode(root, "renderer-v2.symbols.symbol"), nullptr);
    const std::string kinds = CPLGetXMLValue(root, "renderer-v2.attr", "");
    EXPECT_TRUE(kinds.empty() || layer->GetLayerDefn()->GetFieldIndex(kinds.c_str()) >= 0) << kinds;
    const std::string text = CPLGetXMLValue(root, "labeling.settings.text-style.fieldName", "");
    EXPECT_TRUE(text.empty() || layer->GetLayerDefn()->GetFieldIndex("label") >= 0) << text;
    EXPECT_STRNE(layer->GetMetadataItem("DESCRIPTION"), nullptr) << "layer descriptions";
  }
}

TEST(TruthCsv, RoundTrip) {
  const TestFolder folder;
  std::vector<simulation::TruthObject> truth(2);
  truth[0].x_m = 1.25;
  truth[1].label = Label::kObject;
  truth[1].width_m = 0.17;
  write_truth_csv(folder / "truth.csv", truth);
  const auto again = read_truth_csv(folder / "truth.csv");
  ASSERT_EQ(again.size(), 2u);
  EXPECT_EQ(again[0].x_m, 1.25);
  EXPECT_EQ(again[0].name, "T1");
  EXPECT_EQ(again[1].label, Label::kObject);
  EXPECT_TRUE(std::isnan(again[0].z_m));  // the file does not tell it
  EXPECT_THROW(read_truth_csv(folder.file("t.csv", "class,x_m,y_m,width_m\nunseen,0,0,0\n")),
               FileError);
}

TEST(TruthCsv, HasHeightsWhereTheGroundIsNotLevel) {
  const TestFolder folder;
  std::vector<simulation::TruthObject> truth(1);
  truth[0].z_m = -1.5;
  write_truth_csv(folder / "truth.csv", truth, Heights::kWritten);
  EXPECT_EQ(read_truth_csv(folder / "truth.csv").at(0).z_m, -1.5);
  EXPECT_THROW(read_truth_csv(folder.file("t.csv", "class,x_m,y_m,width_m,y_m\ntree,0,0,0,0\n")),
               FileError);

  const std::vector<simulation::TruePose> poses{{1000000, 1.0, 2.0, 0.5, 0.25, -0.1, 0.2}};
  write_poses_csv(folder / "poses.csv", poses, Heights::kWritten);
  EXPECT_EQ(read_bytes(folder / "poses.csv"),
            "utime_us,x_m,y_m,yaw_rad,z_m,roll_rad,pitch_rad\n"
            "1000000,1.0000,2.0000,0.50000,0.2500,-0.10000,0.20000\n");
  EXPECT_EQ(read_track_csv(folder / "poses.csv").poses.at(0).yaw_rad, 0.5);
}

TEST(AtomicFile, AFailureLeavesTheOldFileAndNoTemporary) {
  const TestFolder folder;
  write_file_atomically(folder / "a.txt", "old");
  EXPECT_THROW(replace_file_atomically(folder / "a.txt",
                                       [](const std::string& temporary) {
                                         write_bytes(temporary, "half");
                                         throw FileError("failed");
                                       }),
               FileError);
  EXPECT_EQ(read_bytes(folder / "a.txt"), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  EXPECT_THROW(write_file_atomically("/dev/full", "x"), FileError);
  EXPECT_THROW(write_file_atomically(folder.path(), "x"), FileError);
}

/// In a child with a file system of its own: 0 = as wanted, 77 = not allowed here.
int full_disk_child(const std::string& folder) {
  if (unshare(CLONE_NEWNS) != 0) return 77;
  if (mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return 77;
  if (mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=700k") != 0) return 77;
  try {
    write_map_folder(folder, make_content(16));
  } catch (const FileError&) {
    return 1;  // the first map should have fitted
  }
  std::vector<std::string> before;
  for (const char* file : kFiles) before.push_back(read_bytes(folder + "/" + file));
  bool refused = false;
  try {
    write_map_folder(folder, make_content(5000));
  } catch (const FileError& error) {
    refused = std::string(error.what()).find("No space left") != std::string::npos;
  }
  if (!refused) return 2;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i] != read_bytes(folder + "/" + kFiles[i])) return 3;
  }
  return 0;
}

TEST(MapFolder, OnAFullDiskTheLastGoodMapStays) {
  const TestFolder folder;
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) _exit(full_disk_child(folder.path()));
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "no mount namespace is allowed here";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

std::set<std::string> names_in(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    names.insert(entry.path().filename().string());
  }
  return names;
}

/// The number of a process that has ended.
std::string dead_pid() {
  const pid_t pid = ::fork();
  if (pid == 0) ::_exit(0);
  ::waitpid(pid, nullptr, 0);
  return std::to_string(pid);
}

TEST(MapFolderLock, MakesTheFolderAndLeavesNothingInIt) {
  const TestFolder folder;
  const MapFolderLock place(folder / "a/b");
  EXPECT_TRUE(names_in(place.folder()).empty());
}

TEST(MapFolderLock, RefusesWhatCannotBeWritten) {
  const TestFolder folder;
  write_bytes(folder / "file", "");
  EXPECT_THROW(MapFolderLock{folder / "file"}, FileError);
  EXPECT_THROW(MapFolderLock{"/proc/no/folder"}, FileError);
  if (::geteuid() != 0) {
    fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_THROW(MapFolderLock{folder.path()}, FileError);
    fs::permissions(folder.path(), fs::perms::owner_all);
  }
}

TEST(MapFolderLock, IsOneMappersAlone) {
  const TestFolder folder;
  {
    const MapFolderLock place(folder.path());
    EXPECT_THROW(MapFolderLock{folder.path()}, FileError);
  }
  EXPECT_NO_THROW(MapFolderLock{folder.path()});
}

TEST(MapFolderLock, RemovesTemporariesOfDeadProcessesOfOursAlone) {
  const TestFolder folder;
  const std::string dead = dead_pid(), alive = std::to_string(::getppid());
  for (const std::string& name :
       {".map." + dead + "-0.csv", ".map." + dead + "-12.gpkg", ".trajectory_2." + dead + "-3.csv",
        ".summary." + dead + "-1.json", ".trial." + dead + "-0.csv"}) {
    write_bytes(folder / name, "half");
  }
  const std::set<std::string> kept{".map." + alive + "-0.csv", ".notes." + dead + "-0.csv",
                                   "map." + dead + "-0.csv",   ".map.csv",
                                   ".map." + dead + ".csv",    "map.csv"};
  for (const std::string& name : kept) write_bytes(folder / name, "whole");
  const MapFolderLock place(folder.path());
  EXPECT_EQ(place.num_removed_temporaries(), 5);
  EXPECT_EQ(names_in(folder.path()), kept);
}

TEST(MapFolderLock, SetsAsideWhatIsOfAMapUnderItsTime) {
  const TestFolder folder;
  for (const char* name : {"map.csv", "map.gpkg", "trajectory_2.csv", "x.journal", "notes.txt"}) {
    write_bytes(folder / name, name);
  }
  // 2026-03-04 05:06:07 UTC by its count of seconds since 1970
  ASSERT_EQ(std::system(("touch -d @1772600767 '" + folder.path() + "'/*").c_str()), 0);
  MapFolderLock place(folder.path());
  const std::string aside = place.set_aside({"x.journal"});
  EXPECT_EQ(aside, folder / "earlier_20260304T050607Z");
  EXPECT_EQ(names_in(folder.path()),
            (std::set<std::string>{"earlier_20260304T050607Z", "notes.txt"}));
  EXPECT_EQ(read_bytes(aside + "/map.csv"), "map.csv");
  EXPECT_EQ(names_in(aside).size(), 4u);
  EXPECT_EQ(place.set_aside({"x.journal"}), "");
  write_bytes(folder / "map.csv", "second");
  ASSERT_EQ(std::system(("touch -d @1772600767 '" + folder.path() + "'/map.csv").c_str()), 0);
  EXPECT_EQ(place.set_aside({}), folder / "earlier_20260304T050607Z_2");
}

}  // namespace
}  // namespace orchard::io

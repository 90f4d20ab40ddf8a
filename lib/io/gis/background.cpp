// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/background.hpp"

#include <gdal_priv.h>
#include <gdal_utils.h>
#include <ogr_spatialref.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "io/atomic_file.hpp"
#include "io/confined.hpp"
#include "io/file_error.hpp"
#include "io/gis/gdal_errors.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using Eigen::Vector2d;

constexpr int kSideMax_px = 2048;  // physical: a picture that every browser can draw
constexpr int kJpegQuality = 80;   // physical: libjpeg's scale, where blocks are not seen
constexpr std::uint64_t kSpare_bytes = std::uint64_t{2}
                                       << 20;  // derived: 136 MiB, 5 s (confined.cpp)
constexpr char kForms[] = "a GeoTIFF, or an MBTiles or GeoPackage of tiles";
constexpr std::array<const char*, 4> kDrivers{"GTiff", "MBTiles", "GPKG", nullptr};

using DatasetPointer = std::unique_ptr<GDALDataset>;

/// A plane whose metres are those of the map: at its datum, at its height.
OGRSpatialReference plane_of(const geometry::Georeference& of_map) {
  constexpr double kEarthRadius_m = 6371000.0;
  const geometry::Geodetic middle = geometry::geodetic_of(of_map, Vector2d::Zero());
  OGRSpatialReference plane;
  plane.SetWellKnownGeogCS("WGS84");
  plane.SetTM(middle.latitude_deg, middle.longitude_deg, 1.0 + of_map.altitude_m / kEarthRadius_m,
              0.0, 0.0);
  return plane;
}

/// Point of the plane of a point of the map.
Vector2d in_plane(const geometry::Georeference& of_map, const OGRSpatialReference& plane,
                  const Vector2d& p_map) {
  OGRSpatialReference degrees;
  degrees.SetWellKnownGeogCS("WGS84");
  degrees.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> to_plane(
      OGRCreateCoordinateTransformation(&degrees, &plane));
  const geometry::Geodetic place = geometry::geodetic_of(of_map, p_map);
  double x = place.longitude_deg, y = place.latitude_deg;
  if (!to_plane || !to_plane->Transform(1, &x, &y))
    throw FileError("the map's datum is not on the earth");
  return {x, y};
}

struct Raster {
  int width = 0, height = 0;
  Vector2d low, high;
};

/// Reads inside the confined process.
class BackgroundReader {
 public:
  BackgroundReader(const std::string& path, const geometry::Georeference& of_map)
      : path_(path), of_map_(of_map) {
    OSRSetPROJEnableNetwork(FALSE);
    GDALAllRegister();
    source_.reset(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY,
                                    kDrivers.data(), nullptr, nullptr));
    if (!source_) fail(" is not " + std::string(kForms));
    if (source_->GetSpatialRef() == nullptr) {
      fail(" has no coordinate system; give " + std::string(kForms) + " with one");
    }
    plane_ = plane_of(of_map);
  }

  /// Pixels of the box from its upper left, as red, green and blue.
  std::string pixels(const Raster& raster) {
    const DatasetPointer picture = in_colours();
    auto* memory = GetGDALDriverManager()->GetDriverByName("MEM");
    const DatasetPointer turned(
        memory->Create("", raster.width, raster.height, 4, GDT_Byte, nullptr));
    if (!turned) fail(" shows too much; there is not enough memory");
    place(*turned, raster);
    const char* words[] = {"-r", "bilinear", "-wm", "32", nullptr};
    const std::unique_ptr<GDALWarpAppOptions, decltype(&GDALWarpAppOptionsFree)> options(
        GDALWarpAppOptionsNew(const_cast<char**>(words), nullptr), GDALWarpAppOptionsFree);
    GDALDatasetH sources[] = {GDALDataset::ToHandle(picture.get())};
    int error = 0;
    if (GDALWarp(nullptr, GDALDataset::ToHandle(turned.get()), 1, sources, options.get(), &error) ==
            nullptr ||
        error) {
      fail(" cannot be turned into the map");
    }
    return on_white(*turned, raster);
  }

 private:
  [[noreturn]] void fail(const std::string& words) const {
    throw FileError(path_ + words + (errors_.first().empty() ? "" : " (" + errors_.first() + ")"));
  }

  /// The source with bands of red, green, blue, and where it has it, opacity.
  DatasetPointer in_colours() {
    std::vector<const char*> words{"-of", "VRT"};
    GDALRasterBand* first = source_->GetRasterBand(1);
    if (first == nullptr) fail(" has no picture");
    const int num_bands = source_->GetRasterCount();
    if (first->GetColorTable() != nullptr) {
      words.insert(words.end(), {"-expand", "rgba"});
    } else if (num_bands < 3) {
      words.insert(words.end(), {"-b", "1", "-b", "1", "-b", "1"});
    } else {
      words.insert(words.end(), {"-b", "1", "-b", "2", "-b", "3"});
      const bool has_alpha =
          num_bands > 3 && source_->GetRasterBand(4)->GetColorInterpretation() == GCI_AlphaBand;
      if (has_alpha) words.insert(words.end(), {"-b", "4"});
    }
    if (first->GetRasterDataType() != GDT_Byte)
      words.insert(words.end(), {"-ot", "Byte", "-scale"});
    words.push_back(nullptr);
    const std::unique_ptr<GDALTranslateOptions, decltype(&GDALTranslateOptionsFree)> options(
        GDALTranslateOptionsNew(const_cast<char**>(words.data()), nullptr),
        GDALTranslateOptionsFree);
    int error = 0;
    DatasetPointer picture(GDALDataset::FromHandle(
        GDALTranslate("", GDALDataset::ToHandle(source_.get()), options.get(), &error)));
    if (!picture || error) fail(" cannot be read as a picture");
    return picture;
  }

  void place(GDALDataset& turned, const Raster& raster) const {
    // Upper left corner, and steps of one pixel to the right and down. Far steps, for their digits.
    const Vector2d corner = in_plane(of_map_, plane_, {raster.low.x(), raster.high.y()});
    const Vector2d right = (in_plane(of_map_, plane_, raster.high) - corner) / raster.width;
    const Vector2d down = (in_plane(of_map_, plane_, raster.low) - corner) / raster.height;
    std::array<double, 6> steps{corner.x(), right.x(), down.x(), corner.y(), right.y(), down.y()};
    turned.SetGeoTransform(steps.data());
    turned.SetSpatialRef(&plane_);
    turned.GetRasterBand(4)->SetColorInterpretation(GCI_AlphaBand);
  }

  std::string on_white(GDALDataset& turned, const Raster& raster) const {
    const std::size_t num =
        static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height);
    std::string rgba(4 * num, '\0');
    if (turned.RasterIO(GF_Read, 0, 0, raster.width, raster.height, rgba.data(), raster.width,
                        raster.height, GDT_Byte, 4, nullptr, 4,
                        4 * static_cast<GSpacing>(raster.width), 1, nullptr) != CE_None) {
      fail(" cannot be read");
    }
    bool is_seen = false;
    std::string rgb(3 * num, '\xff');
    for (std::size_t i = 0; i < num; ++i) {
      if (rgba[4 * i + 3] == 0) continue;
      is_seen = true;
      std::memcpy(&rgb[3 * i], &rgba[4 * i], 3);
    }
    if (!is_seen) fail(" shows nothing of the map's place; give a picture of this block");
    return rgb;
  }

  std::string path_;
  geometry::Georeference of_map_;
  GdalErrors errors_;
  DatasetPointer source_;
  OGRSpatialReference plane_;
};

}  // namespace

view::Background background_of(const std::string& path, const geometry::Georeference& georeference,
                               const Eigen::AlignedBox2d& box_map) {
  Raster raster{0, 0, box_map.min(), box_map.max()};
  const Vector2d size = raster.high - raster.low;
  const double step_m = size.maxCoeff() / kSideMax_px;
  raster.width = std::max(1, static_cast<int>(size.x() / step_m));
  raster.height = std::max(1, static_cast<int>(size.y() / step_m));
  std::error_code error;
  const std::uintmax_t file_bytes = std::filesystem::file_size(path, error);
  if (error) throw FileError("cannot read " + path + ": " + error.message());
  const std::string rgb = read_confined(path, file_bytes + kSpare_bytes, [&] {
    return BackgroundReader(path, georeference).pixels(raster);
  });
  const cv::Mat picture(raster.height, raster.width, CV_8UC3, const_cast<char*>(rgb.data()));
  cv::Mat bgr;
  cv::cvtColor(picture, bgr, cv::COLOR_RGB2BGR);
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", bgr, jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  view::Background background;
  background.jpeg.assign(jpeg.begin(), jpeg.end());
  background.low_map = raster.low;
  background.high_map = raster.high;
  return background;
}

}  // namespace orchard::io

// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/board_views.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <variant>

#include "bus/messages/codec.hpp"
#include "io/file_error.hpp"
#include "io/log/log_reader.hpp"
#include "io/progress_bar.hpp"
#include "io/recording/picture_file.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

namespace fs = std::filesystem;

/// Max number of pictures of a log to search: a board moves slowly, and each picture takes about 20
/// ms.
constexpr std::size_t kMaxSearched = 400;

/// Searches pictures one by one and requires them to have equal size.
class Search {
 public:
  Search(const calibration::BoardConfig& board, BoardViews& found) : board_(board), found_(found) {}

  void add(const std::string& name, const calibration::GreyPicture& picture) {
    if (first_name_.empty()) {
      first_name_ = name;
      found_.width_px = picture.width_px;
      found_.height_px = picture.height_px;
    } else if (picture.width_px != found_.width_px || picture.height_px != found_.height_px) {
      throw io::FileError(name + ": its size is " + size(picture.width_px, picture.height_px) +
                          " pixels, but that of " + first_name_ + " is " +
                          size(found_.width_px, found_.height_px) +
                          "; give pictures of one camera and one size");
    }
    if (auto view = calibration::find_board(picture, board_)) {
      found_.views.push_back({name, std::move(*view)});
    } else {
      found_.without_board.push_back(name);
    }
  }

 private:
  static std::string size(int width_px, int height_px) {
    return std::to_string(width_px) + " x " + std::to_string(height_px);
  }

  const calibration::BoardConfig& board_;
  BoardViews& found_;
  std::string first_name_;
};

std::vector<std::string> picture_files(const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    if (!fs::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    std::vector<std::string> inside;
    for (const auto& entry : fs::directory_iterator(path)) {
      if (entry.is_regular_file() && io::has_picture_name(entry.path().string())) {
        inside.push_back(entry.path().string());
      }
    }
    if (inside.empty()) {
      throw io::FileError(path +
                          ": this folder has no pictures (.jpg, .jpeg, .png); give the folder with "
                          "the pictures of the board");
    }
    std::sort(inside.begin(), inside.end());
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

void search_files(const std::vector<std::string>& files, Search& search, bool quiet) {
  io::ProgressBar bar("looking for the board", !quiet);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto picture = calibration::grey_of(io::read_picture_file(files[i]));
    if (!picture) {
      throw io::FileError(files[i] + ": this picture is damaged; remove or replace it");
    }
    search.add(files[i], *picture);
    bar.update(i + 1, files.size());
  }
}

void search_log(const std::string& path, Search& search, bool quiet) {
  const auto image_channel = bus::info(bus::Channel::kImage).name;
  io::LogReader reader(path);
  std::vector<std::uint64_t> offsets;
  io::ProgressBar reading("reading " + path, !quiet);
  while (const auto event = reader.next()) {
    if (event->channel == image_channel) offsets.push_back(event->offset);
    reading.update(reader.position(), reader.file_size());
  }
  reading.finish();
  if (offsets.empty()) {
    throw io::FileError(path + ": " +
                        (reader.num_events() == 0 ? "this file is neither an LCM log nor a picture"
                                                  : "this log has no IMAGE") +
                        "; give pictures (.jpg, .png), a folder of them, or a log with " +
                        std::string(image_channel));
  }
  io::ProgressBar bar("looking for the board", !quiet);
  const std::size_t num = std::min(offsets.size(), kMaxSearched);
  std::int64_t first_utime = 0;
  int num_refused = 0;
  for (std::size_t i = 0; i < num; ++i) {
    const io::LogEvent event = reader.read_at(offsets[i * offsets.size() / num]);
    const auto decoded = bus::decode(bus::Channel::kImage, event.data.data(), event.data.size());
    const auto* message = std::get_if<bus::Message>(&decoded);
    const auto picture = message ? calibration::grey_of(std::get<vision::Image>(*message))
                                 : std::optional<calibration::GreyPicture>();
    bar.update(i + 1, num);
    if (!picture) {
      ++num_refused;
      continue;
    }
    const std::int64_t utime = bus::utime_of(*message);
    if (first_utime == 0) first_utime = utime;
    search.add(
        path + " at " + fixed_text(1e-6 * static_cast<double>(utime - first_utime), 2) + " s",
        *picture);
  }
  bar.finish();
  if (num_refused > 0) {
    std::fprintf(stderr, "orchard calibrate: warning: %s: %d of %zu pictures are damaged\n",
                 path.c_str(), num_refused, num);
  }
}

}  // namespace

BoardViews find_board_views(const std::vector<std::string>& paths,
                            const calibration::BoardConfig& board, bool quiet) {
  BoardViews found;
  Search search(board, found);
  const bool is_log =
      paths.size() == 1 && fs::is_regular_file(paths[0]) && !io::has_picture_name(paths[0]);
  if (is_log) {
    search_log(paths[0], search, quiet);
    found.source = fs::path(paths[0]).filename().string();
  } else {
    const std::vector<std::string> files = picture_files(paths);
    search_files(files, search, quiet);
    found.source = std::to_string(files.size()) + " pictures";
  }
  if (found.views.empty()) {
    const bool chess = board.kind == calibration::BoardConfig::kChessboard;
    throw io::FileError(
        "no board was found in any of the " + std::to_string(found.without_board.size()) +
        " pictures (the first is " + found.without_board.front() + "); show a " +
        (chess ? "chessboard" : "ChArUco board") + " of " + std::to_string(board.columns) + " x " +
        std::to_string(board.rows) + (chess ? " inner corners" : " squares") +
        " (--columns, --rows) entirely in view, sharp and with a white margin");
  }
  return found;
}

}  // namespace orchard::cli

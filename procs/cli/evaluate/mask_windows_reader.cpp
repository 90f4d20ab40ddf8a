// SPDX-License-Identifier: BSD-3-Clause
#include "cli/evaluate/mask_windows_reader.hpp"

#include <cstdint>
#include <cstdio>
#include <map>

#include "io/file_error.hpp"
#include "io/progress_bar.hpp"

namespace orchard::cli {
namespace {

/// Seed of a picture (FNV-1a of its name), so that its windows do not depend on the other pictures.
std::uint64_t seed_of(const std::string& name, std::uint64_t seed) {
  std::uint64_t hash = 1469598103934665603ull;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return hash + seed;
}

}  // namespace

PictureCount for_each_masked_picture(const MaskedPictureOptions& options, const char* command,
                                     bool quiet,
                                     const std::function<void(const PictureWindows&)>& visit) {
  const io::MaskedPictureList list =
      io::list_masked_pictures(options.picture_folder, options.mask_folder, options.only);
  PictureCount count;
  for (const std::string& name : list.without_mask) {
    count.left_out.push_back(name + ": has no mask of the same name in " + options.mask_folder);
  }
  std::map<std::int64_t, int> group_of_size;
  io::ProgressBar bar("reading pictures", !quiet);
  std::uint64_t done = 0;
  for (const io::MaskedPicturePaths& paths : list.pictures) {
    bar.update(done++, list.pictures.size());
    PictureWindows picture;
    picture.name = paths.name;
    try {
      picture.picture = io::read_masked_picture(paths);
    } catch (const io::FileError& error) {
      count.left_out.push_back(error.what());
      continue;
    }
    calibration::MaskWindowOptions where = options.windows;
    where.seed = seed_of(paths.name, where.seed);
    picture.windows = calibration::sample_windows(picture.picture.mask, where);
    if (picture.windows.empty()) {
      count.left_out.push_back(paths.picture +
                               ": has no space for windows both on and off the trunk");
      continue;
    }
    const std::int64_t size = picture.picture.mask.num_trunk_px();
    picture.group =
        group_of_size.emplace(size, static_cast<int>(group_of_size.size())).first->second;
    visit(picture);
    ++count.used;
  }
  bar.finish();
  if (count.used == 0) {
    throw io::FileError(
        options.picture_folder +
        ": no picture could be used; the reason for the first: " + count.left_out.front());
  }
  for (const std::string& sentence : count.left_out) {
    std::fprintf(stderr, "%s: warning: picture not used: %s\n", command, sentence.c_str());
  }
  count.num_groups = static_cast<int>(group_of_size.size());
  return count;
}

}  // namespace orchard::cli

// SPDX-License-Identifier: BSD-3-Clause
//
// Any text is a table or a FileError. The first byte chooses the table.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "fuzz/fuzz_seeds.hpp"
#include "io/file_error.hpp"
#include "io/map/map_csv.hpp"
#include "io/recording/recording_folder.hpp"
#include "io/recording/truth_csv.hpp"

using namespace orchard;

namespace {

template <class Table>
void read_all(Table table) {
  while (table.next()) {
  }
}

/// A file in memory, as the readers take names of files only.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* bytes, std::size_t size) : fd_(::memfd_create("table.csv", 0)) {
    if (::write(fd_, bytes, size) != static_cast<ssize_t>(size)) std::abort();
  }
  ~MemoryFile() { ::close(fd_); }
  std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const MemoryFile file(data + 1, size - 1);
  try {
    switch (data[0] % 7) {
      case 0:
        io::read_truth_csv(file.path());
        break;
      case 1:
        io::read_map_csv(file.path());
        break;
      case 2:
        io::read_trajectory_csv(file.path());
        break;
      case 3: {
        io::LaserDescription laser;
        laser.num_beams = 3;
        laser.bearing_step_rad = 0.01;
        read_all(io::ScanCsv(io::CsvReader::open(file.path()), laser));
        break;
      }
      case 4:
        read_all(io::odometry_csv(io::CsvReader::open(file.path())));
        break;
      case 5:
        read_all(io::gnss_csv(io::CsvReader::open(file.path())));
        break;
      default:
        read_all(io::pose_fix_csv(io::CsvReader::open(file.path())));
    }
  } catch (const io::FileError&) {
  }
  return 0;
}

namespace orchard::fuzz {

std::vector<std::string> seeds() {
  const std::string tables[] = {
      "class,x_m,y_m,width_m\ntree,1.5,-2,0.09\nobject,0,0,0.17\n",
      "id,class,x_m,y_m,n,roc_mean,probability,se_x_m,se_y_m,width_m,row,position\n"
      "1,tree,0.5000,1.0000,8,0.8700,0.9999,0.0050,0.0060,0.0900,1,2\n"
      "2,unseen,0.5000,1.0000,8,0.8700,0.9999,0.0050,0.0060,0.0900,,\n",
      "utime_us,x_m,y_m,yaw_rad\n100,1.0,2.0,3.14\n200,1.0,2.0,-3.15\n",
      "utime_us,range_0_m,range_1_m,range_2_m\n100,0,1.5,2.25\n200,0,0,0\n",
      "utime_us,v_mps,yaw_rate_radps\n100,0.5,-0.01\n200,0.5,0\n",
      "utime_us,latitude_deg,longitude_deg,altitude_m\n100,-32.4,-71.3,41.9\n",
      "utime_us,x_m,y_m,yaw_rad\n100,1.0,2.0,3.14\n"};
  std::vector<std::string> seeds;
  for (std::size_t i = 0; i < std::size(tables); ++i) {
    seeds.push_back(static_cast<char>(i) + tables[i]);
  }
  return seeds;
}

}  // namespace orchard::fuzz

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <httplib.h>
#undef _res  // a macro of resolv.h, and a name in Eigen

#include <cstddef>

namespace orchard::procs {

/// The library's HTTP server, which reads headers without a limit of their number: here a request
/// has at most so many bytes, and closes its connection.
class BoundedHttpServer final : public httplib::Server {
 public:
  explicit BoundedHttpServer(std::size_t request_bytes_max)
      : request_bytes_max_(request_bytes_max) {}

 private:
  bool process_and_close_socket(socket_t socket) override;

  std::size_t request_bytes_max_;
};

}  // namespace orchard::procs

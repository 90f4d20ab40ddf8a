// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

struct pg_conn;

namespace orchard::io {

/// A connection to PostgreSQL. Errors are std::runtime_error, one sentence with the server's own
/// words; what was not committed is taken back when it ends.
class PostgresConnection {
 public:
  /// Waits ten seconds at most unless the URL says otherwise (connect_timeout). Throws FileError
  /// for a URL that is none or that holds a password.
  explicit PostgresConnection(const std::string& url);
  ~PostgresConnection();
  PostgresConnection(const PostgresConnection&) = delete;
  PostgresConnection& operator=(const PostgresConnection&) = delete;

  /// Several statements without arguments.
  void run(const char* statements);

  /// One statement with $1, $2 ...; the number of lines it changed, or, for a SELECT, gave.
  std::int64_t run(const char* statement, const std::vector<std::string>& arguments);

  /// Sends text lines to the COPY ... FROM STDIN that `statement` is.
  void begin_copy(const char* statement);
  void copy(std::string_view lines);
  void end_copy();

 private:
  [[noreturn]] void fail(const char* what) const;

  struct Closer {
    void operator()(pg_conn* connection) const;
  };
  std::unique_ptr<pg_conn, Closer> connection_;
};

}  // namespace orchard::io

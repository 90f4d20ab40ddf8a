// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

struct pg_conn;

namespace orchard::io {

/// A connection to PostgreSQL. Errors are std::runtime_error with the server's message in one
/// sentence. Uncommitted changes are rolled back when the connection ends.
class PostgresConnection {
 public:
  /// Waits at most ten seconds unless the URL sets connect_timeout. Throws FileError for an invalid
  /// URL or one with a password.
  explicit PostgresConnection(const std::string& url);
  ~PostgresConnection();
  PostgresConnection(const PostgresConnection&) = delete;
  PostgresConnection& operator=(const PostgresConnection&) = delete;

  /// Executes several statements without arguments.
  void run(const char* statements);

  /// Executes one statement with $1, $2 ...; returns the number of rows it changed or, for a
  /// SELECT, returned.
  std::int64_t run(const char* statement, const std::vector<std::string>& arguments);

  /// Sends text lines to `statement`, a COPY ... FROM STDIN.
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

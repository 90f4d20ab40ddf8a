// SPDX-License-Identifier: BSD-3-Clause
#include "io/postgis/connection.hpp"

#include <libpq-fe.h>

#include <cstdlib>
#include <stdexcept>

#include "io/file_error.hpp"

namespace orchard::io {
namespace {

struct ResultClearer {
  void operator()(PGresult* result) const { PQclear(result); }
};
using Result = std::unique_ptr<PGresult, ResultClearer>;

/// The first line of a server message, which states the error; the others refer to our SQL.
std::string first_line(const char* message) {
  std::string text = message == nullptr ? "" : message;
  text = text.substr(0, text.find('\n'));
  return text.empty() ? "no reason given" : text;
}

void require_no_password(const std::string& url) {
  char* error = nullptr;
  PQconninfoOption* options = PQconninfoParse(url.c_str(), &error);
  if (options == nullptr) {
    PQfreemem(error);  // it may contain the password
    throw FileError(
        "--to: this is not a PostgreSQL URL; give one such as postgresql://user@host/database");
  }
  bool has_password = false;
  for (const PQconninfoOption* o = options; o->keyword != nullptr; ++o) {
    if (std::string(o->keyword) == "password" && o->val != nullptr) has_password = true;
  }
  PQconninfoFree(options);
  if (has_password) {
    throw FileError(
        "--to: a password on the command line is visible to everyone on this machine; put it into "
        "~/.pgpass (mode 600), a service file or PGPASSWORD instead");
  }
}

}  // namespace

void PostgresConnection::Closer::operator()(pg_conn* connection) const { PQfinish(connection); }

PostgresConnection::PostgresConnection(const std::string& url) {
  require_no_password(url);
  const bool has_timeout = url.find("connect_timeout") != std::string::npos ||
                           std::getenv("PGCONNECT_TIMEOUT") != nullptr;
  // later entries of the list win, so the URL's own application_name does
  const char* keys[] = {"application_name", "client_encoding",
                        has_timeout ? "dbname" : "connect_timeout",
                        has_timeout ? nullptr : "dbname", nullptr};
  const char* values[] = {"orchard publish", "UTF8", has_timeout ? url.c_str() : "10",
                          has_timeout ? nullptr : url.c_str(), nullptr};
  connection_.reset(PQconnectdbParams(keys, values, 1));
  if (PQstatus(connection_.get()) != CONNECTION_OK) fail("no connection to the database");
  PQsetNoticeProcessor(
      connection_.get(), [](void*, const char*) {}, nullptr);
}

PostgresConnection::~PostgresConnection() = default;

void PostgresConnection::fail(const char* what) const {
  throw std::runtime_error(std::string(what) + ": " +
                           first_line(PQerrorMessage(connection_.get())) +
                           "; nothing was published");
}

void PostgresConnection::run(const char* statements) {
  const Result result(PQexec(connection_.get(), statements));
  const ExecStatusType status = PQresultStatus(result.get());
  if (status != PGRES_COMMAND_OK && status != PGRES_TUPLES_OK)
    fail("the database refused the request");
}

std::int64_t PostgresConnection::run(const char* statement,
                                     const std::vector<std::string>& arguments) {
  std::vector<const char*> values;
  for (const std::string& a : arguments) values.push_back(a.c_str());
  const Result result(PQexecParams(connection_.get(), statement, static_cast<int>(values.size()),
                                   nullptr, values.data(), nullptr, nullptr, 0));
  const ExecStatusType status = PQresultStatus(result.get());
  if (status == PGRES_TUPLES_OK) return PQntuples(result.get());
  if (status != PGRES_COMMAND_OK) fail("the database refused the request");
  return std::strtoll(PQcmdTuples(result.get()), nullptr, 10);
}

void PostgresConnection::begin_copy(const char* statement) {
  const Result result(PQexec(connection_.get(), statement));
  if (PQresultStatus(result.get()) != PGRES_COPY_IN) fail("the database refused the request");
}

void PostgresConnection::copy(std::string_view lines) {
  if (PQputCopyData(connection_.get(), lines.data(), static_cast<int>(lines.size())) != 1) {
    fail("the connection was lost");
  }
}

void PostgresConnection::end_copy() {
  if (PQputCopyEnd(connection_.get(), nullptr) != 1) fail("the connection was lost");
  bool is_good = true;
  while (Result result{PQgetResult(connection_.get())}) {
    is_good = is_good && PQresultStatus(result.get()) == PGRES_COMMAND_OK;
  }
  if (!is_good) fail("the database refused the request");
}

}  // namespace orchard::io

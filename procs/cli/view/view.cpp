// SPDX-License-Identifier: BSD-3-Clause
#include "cli/view/view.hpp"

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>

#include "bus/node/stop_signal.hpp"
#include "bus/process/process.hpp"
#include "cli/view/folder_page.hpp"
#include "cli/view/log_page.hpp"
#include "io/file_error.hpp"
#include "log_player/replay_rig.hpp"
#include "viewer/page_server.hpp"
#include "viewer/viewer_process.hpp"

extern char** environ;

namespace orchard::cli {
namespace {

constexpr int kRefresh_ms = 500;  ///< period of checking for corrections by others

/// Opens the user's browser; does nothing when there is none.
void open_in_browser(const std::string& url) {
  std::string program = "xdg-open", address = url;
  char* arguments[] = {program.data(), address.data(), nullptr};
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t none;  // the browser must end at Ctrl-C, which this program blocks
  sigemptyset(&none);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t child = 0;
  if (::posix_spawnp(&child, "xdg-open", nullptr, &attributes, arguments, environ) != 0) {
    std::fprintf(stderr,
                 "orchard view: xdg-open is not installed, so no browser was opened; open the "
                 "address below\n");
  }
  ::posix_spawnattr_destroy(&attributes);
}

/// A temporary file, readable only by this user, that redirects to the page. As a command-line
/// argument of the browser, the token would be visible to all users of this machine. The destructor
/// removes it.
class TokenPage {
 public:
  TokenPage(const std::string& url, const std::string& token) {
    std::error_code error;
    const auto folder = std::filesystem::temp_directory_path(error);
    path_ = (error ? "." : folder.string()) + "/orchard_view_XXXXXX.html";
    const int fd = ::mkstemps(path_.data(), 5);
    if (fd < 0) throw io::FileError(path_ + " cannot be written; set TMPDIR to a folder that can");
    const std::string text = "<!DOCTYPE html><meta http-equiv=\"refresh\" content=\"0;url=" + url +
                             "?token=" + token + "\">\n";
    const ssize_t written = ::write(fd, text.data(), text.size());
    ::close(fd);
    if (written != static_cast<ssize_t>(text.size())) {
      ::unlink(path_.c_str());
      throw io::FileError(path_ + " cannot be written; set TMPDIR to a folder that can");
    }
  }
  ~TokenPage() { ::unlink(path_.c_str()); }
  TokenPage(const TokenPage&) = delete;
  TokenPage& operator=(const TokenPage&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

void require_sense(const ViewOptions& options, bool is_folder) {
  if (options.edit && !is_folder) {
    throw io::FileError(
        "--edit needs a map folder; map the log first (`orchard map`), then run `orchard view "
        "FOLDER --edit`");
  }
  if (is_folder && options.paths.size() > 1) {
    throw io::FileError("give either one map folder or the logs of one drive");
  }
}

}  // namespace

int run_view(const ViewOptions& options) {
  const bool is_folder = std::filesystem::is_directory(options.paths.front());
  require_sense(options, is_folder);
  procs::PageServerOptions server = procs::parse_listen(options.listen);
  if (!options.token_file.empty()) server.token = procs::read_token(options.token_file);
  std::unique_ptr<FolderPage> folder;
  std::optional<procs::ReplayRig> rig;
  const io::LogPaths logs(options.paths);
  if (is_folder) {
    folder = std::make_unique<FolderPage>(options.paths.front(), options.edit);
  } else {
    rig = procs::choose_rig(logs, options.config_path);
    for (const std::string& note : rig->notes) {
      std::fprintf(stderr, "orchard view: note: %s\n", note.c_str());
    }
  }
  // Before this line Ctrl-C ends the program; from here on all threads block the signals.
  bus::StopSignal stop;
  std::unique_ptr<LogPage> log;
  if (rig) log = std::make_unique<LogPage>(logs, rig->config, ORCHARD_VERSION);
  procs::PageContent& content =
      folder ? static_cast<procs::PageContent&>(*folder) : static_cast<procs::PageContent&>(*log);
  const procs::PageServer page(content, server);
  std::printf("the page is at %s%s%s; stop with Ctrl-C\n", page.url().c_str(),
              server.token.empty() ? "" : "?token=...",
              options.edit ? " (corrections are saved)" : "");
  std::fflush(stdout);
  std::optional<TokenPage> token_page;
  if (options.open && !server.token.empty()) token_page.emplace(page.url(), server.token);
  if (options.open) open_in_browser(token_page ? token_page->path() : page.url());
  bool is_told = false, has_failed = false;
  while (!stop.raised()) {
    stop.wait(-1, kRefresh_ms);
    while (::waitpid(-1, nullptr, WNOHANG) > 0) {  // reap the browser's launcher
    }
    if (folder) folder->look_for_corrections();
    if (log && !is_told && !log->outcome().empty()) {
      is_told = true;
      const std::string outcome = log->outcome();
      has_failed = outcome != "ok";
      if (has_failed) std::fprintf(stderr, "orchard view: %s\n", outcome.c_str());
    }
  }
  return has_failed ? bus::kExitInput : bus::kExitOk;
}

}  // namespace orchard::cli

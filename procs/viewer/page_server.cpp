// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/page_server.hpp"

#include <netinet/tcp.h>
#include <sys/resource.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "view/page.hpp"
#include "viewer/bounded_http_server.hpp"

namespace orchard::procs {
namespace {

constexpr std::chrono::milliseconds kEventPeriod{150};  ///< faster updates are not perceptible
constexpr std::chrono::seconds kAliveAfter{10};  ///< of silence: sends a comment to keep alive
constexpr int kThreads = PageServer::kStreamsMax + 12;
constexpr int kNextPorts = 20;
constexpr char kEditPath[] = "/api/edit";
constexpr std::size_t kEditMax_bytes = 16384;
constexpr std::size_t kHeadMax_bytes = 16384;   ///< of a request; browsers send a tenth
constexpr std::size_t kPackedMin_bytes = 1400;  ///< less fits into one packet as it is
constexpr std::size_t kParametersMax = 8, kParameterMax_bytes = 100;

/// Send buffer in the kernel for a slow client [bytes].
constexpr int kSendBuffer = 256 * 1024;

/// Max number of connections, including waiting ones; the kernel refuses more.
constexpr rlim_t kFilesMax = 512;

void limit_files() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur <= kFilesMax) return;
  limit.rlim_cur = kFilesMax;
  setrlimit(RLIMIT_NOFILE, &limit);
}

std::string cookie_token(const httplib::Request& request) {
  const std::string cookies = request.get_header_value("Cookie");
  const std::string name = "orchard_token=";
  for (std::size_t begin = 0; begin < cookies.size();) {
    begin = std::min(cookies.find_first_not_of(' ', begin), cookies.size());
    const std::size_t end = std::min(cookies.find(';', begin), cookies.size());
    const std::string pair = cookies.substr(begin, end - begin);
    if (pair.rfind(name, 0) == 0) return pair.substr(name.size());
    begin = end + 1;
  }
  return {};
}

/// A host's name in the form in which names are compared (RFC 9110, 4.2.3).
std::string in_lower_case(std::string name) {
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

/// True if the request comes from this server's own page. Another page cannot send JSON without a
/// preflight request, which is refused, and an Origin header must name this server.
bool is_from_own_page(const httplib::Request& request) {
  if (request.get_header_value("Content-Type").rfind("application/json", 0) != 0) return false;
  const std::string origin = in_lower_case(request.get_header_value("Origin"));
  return origin.empty() || origin == "http://" + in_lower_case(request.get_header_value("Host"));
}

PageContent::Parameters parameters_of(const httplib::Request& request) {
  PageContent::Parameters parameters;
  for (const auto& [name, value] : request.params) {
    if (parameters.size() >= kParametersMax) break;
    if (name.size() <= kParameterMax_bytes && value.size() <= kParameterMax_bytes) {
      parameters[name] = value;
    }
  }
  return parameters;
}

/// Whether an Accept-Encoding header of HTTP (RFC 9110, 12.5.3) allows gzip by name.
bool accepts_gzip(const std::string& accept_encoding) {
  for (std::size_t begin = 0; begin <= accept_encoding.size();) {
    const std::size_t end = std::min(accept_encoding.find(',', begin), accept_encoding.size());
    std::string coding;
    for (std::size_t k = begin; k < end; ++k) {
      if (accept_encoding[k] != ' ' && accept_encoding[k] != '\t') coding += accept_encoding[k];
    }
    begin = end + 1;
    if (coding == "gzip") return true;
    if (coding.rfind("gzip;q=", 0) == 0) return coding.find_first_of("123456789", 7) != coding.npos;
  }
  return false;
}

/// Packs a text as gzip (RFC 1952), fast rather than small; empty if there is no memory for it.
std::string gzip(const std::string& text) {
  constexpr int kGzip_window = 15 + 16;  // zlib's way to ask for gzip's frame
  z_stream stream{};
  if (text.size() > std::numeric_limits<uInt>::max() / 2 ||
      deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kGzip_window, 8, Z_DEFAULT_STRATEGY) !=
          Z_OK) {
    return {};
  }
  std::string packed(deflateBound(&stream, static_cast<uLong>(text.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const bool is_done = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  packed.resize(is_done ? stream.total_out : 0);
  deflateEnd(&stream);
  return packed;
}

/// Sends a text packed by gzip to who takes it. The library alone would pack it by Brotli, as small
/// as that can: seconds of a core for a page or a tile.
void send(const httplib::Request& request, std::string text, const std::string& type,
          httplib::Response& response) {
  if (text.empty()) return response.set_content(text, type);
  const bool is_text = type.rfind("text/", 0) == 0 || type == "application/json";
  std::string packed;
  if (is_text && text.size() >= kPackedMin_bytes &&
      accepts_gzip(request.get_header_value("Accept-Encoding"))) {
    packed = gzip(text);
  }
  if (!packed.empty()) response.set_header("Content-Encoding", "gzip");
  if (is_text) response.set_header("Vary", "Accept-Encoding");
  const auto body = std::make_shared<const std::string>(std::move(packed.empty() ? text : packed));
  // A text of known length from a provider is sent as it is.
  response.set_content_provider(body->size(), type.c_str(),
                                [body](std::size_t at, std::size_t num, httplib::DataSink& sink) {
                                  return sink.write(body->data() + at, num);
                                });
}

/// True if an address is a loopback address.
bool is_loopback(const std::string& address) {
  return address.rfind("127.", 0) == 0 || address == "::1" || address == "localhost";
}

/// True if a request's Host header is valid for a page of a loopback server. Another name that
/// resolves to this host indicates a foreign page (DNS rebinding).
bool is_own_host(const std::string& given, const std::string& address, int port) {
  const std::string host = in_lower_case(given);
  const std::string at_port = ":" + std::to_string(port);
  for (const std::string& name : {std::string("localhost"), std::string("127.0.0.1"),
                                  std::string("[::1]"), in_lower_case(address)}) {
    if (host == name + at_port || host == name) return true;
  }
  return false;
}

/// Compares two texts in a time that does not reveal where they differ.
bool is_same_secret(const std::string& a, const std::string& b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const char other = b.empty() ? '\0' : b[k % b.size()];
    difference |= static_cast<unsigned char>(a[k]) ^ static_cast<unsigned char>(other);
  }
  return difference == 0;
}

}  // namespace

struct PageServer::Impl {
  Impl(PageContent& shown, const PageServerOptions& given) : content(shown), options(given) {}

  void set_up();
  void bind();
  httplib::Server::HandlerResponse admit(const httplib::Request& request,
                                         httplib::Response& response) const;
  void stream(const httplib::Request& request, httplib::Response& response);
  void answer(const httplib::Request& request, const std::optional<PageAnswer>& answer,
              httplib::Response& response) const;

  PageContent& content;
  PageServerOptions options;
  std::string url;
  BoundedHttpServer server{kHeadMax_bytes + kEditMax_bytes};
  std::atomic<bool> is_stopping{false};
  std::atomic<int> num_streams{0};
  std::thread thread;
};

httplib::Server::HandlerResponse PageServer::Impl::admit(const httplib::Request& request,
                                                         httplib::Response& response) const {
  using Handled = httplib::Server::HandlerResponse;
  const auto refuse = [&](int status, const char* words) {
    response.status = status;
    response.set_content(words, "text/plain");
    return Handled::Handled;
  };
  const bool is_edit = request.method == "POST" && request.path == kEditPath && content.can_edit();
  if (request.method != "GET" && request.method != "HEAD" && !is_edit) {
    return refuse(405, "This page is read-only.\n");
  }
  if (is_edit && !is_from_own_page(request)) {
    return refuse(403, "Edits are accepted only from this server's own page.\n");
  }
  if (is_edit && request.has_header("Content-Encoding")) {  // our pages never compress requests
    return refuse(415, "Send an edit without Content-Encoding.\n");
  }
  if (options.token.empty()) {
    const bool is_ours =
        is_own_host(request.get_header_value("Host"), options.address, options.port);
    return is_ours ? Handled::Unhandled
                   : refuse(403, "Use 127.0.0.1 as the host in the address.\n");
  }
  const bool is_given = request.has_param("token");
  const std::string token = is_given ? request.get_param_value("token") : cookie_token(request);
  if (!is_same_secret(options.token, token)) {
    return refuse(403,
                  "Add ?token=... to the address, with the token of the viewer's --token-file.\n");
  }
  if (is_given) {
    response.set_header("Set-Cookie",
                        "orchard_token=" + options.token + "; HttpOnly; SameSite=Strict; Path=/");
  }
  return Handled::Unhandled;
}

void PageServer::Impl::answer(const httplib::Request& request,
                              const std::optional<PageAnswer>& answer,
                              httplib::Response& response) const {
  response.set_header("Cache-Control", "no-store");
  if (!answer) {
    response.status = 404;
    return;
  }
  response.status = answer->status;
  send(request, answer->body, answer->type, response);
}

void PageServer::Impl::stream(const httplib::Request& request, httplib::Response& response) {
  if (num_streams.fetch_add(1) >= kStreamsMax) {
    --num_streams;
    response.status = 503;
    response.set_content("Too many browsers are connected. Close one of them.\n", "text/plain");
    return;
  }
  struct Client {
    view::ViewerProgress seen;
    bool is_greeted = false;
    std::chrono::steady_clock::time_point last = std::chrono::steady_clock::now();
  };
  const auto client = std::make_shared<Client>();
  client->seen.map = std::atoll(request.get_param_value("map").c_str());  // of the page
  response.set_header("Cache-Control", "no-store");
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, client](std::size_t, httplib::DataSink& sink) {
        if (is_stopping) return false;
        bool is_more = false;
        std::string text;
        // A client that reconnects after a break gets everything again.
        if (!client->is_greeted) text = "retry: 1000\ndata: " + content.hello() + "\n\n";
        client->is_greeted = true;
        for (const std::string& event : content.events_for(client->seen, is_more)) {
          text += "data: " + event + "\n\n";
        }
        const auto now = std::chrono::steady_clock::now();
        if (text.empty() && now - client->last > kAliveAfter) text = ":\n\n";
        if (!text.empty()) {
          client->last = now;
          if (!sink.write(text.data(), text.size())) return false;
        }
        if (!is_more) std::this_thread::sleep_for(kEventPeriod);
        return true;
      },
      [this](bool) { --num_streams; });
}

void PageServer::Impl::set_up() {
  server.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  server.set_payload_max_length(kEditMax_bytes);
  // One request per connection (BoundedHttpServer): the body of a rejected request is not read and,
  // on a persistent connection, would be parsed as the next request, with arbitrary headers.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &kSendBuffer, sizeof(kSendBuffer));
  });
  server.set_default_headers({{"X-Content-Type-Options", "nosniff"},
                              {"X-Frame-Options", "DENY"},
                              {"Referrer-Policy", "no-referrer"},
                              {"Cross-Origin-Resource-Policy", "same-origin"}});
  server.set_pre_routing_handler(
      [this](const auto& request, auto& response) { return admit(request, response); });
  server.Get("/", [this](const httplib::Request& request, httplib::Response& response) {
    response.set_header("Content-Security-Policy",
                        view::page_policy(view::PageSource::kServer) + "; frame-ancestors 'none'");
    send(request, content.page(), "text/html; charset=utf-8", response);
  });
  server.Get("/api/stream", [this](const httplib::Request& request, httplib::Response& response) {
    stream(request, response);
  });
  server.Get(R"(/api/([a-z]{1,16}))",
             [this](const httplib::Request& request, httplib::Response& response) {
               answer(request, content.get(request.matches[1], parameters_of(request)), response);
             });
  server.Post(kEditPath, [this](const httplib::Request& request, httplib::Response& response) {
    answer(request, content.edit(request.body), response);
  });
}

void PageServer::Impl::bind() {
  const int last = options.port + (options.may_move ? kNextPorts : 0);
  while (!server.bind_to_port(options.address, options.port)) {
    if (++options.port > last) {
      throw std::runtime_error(options.address + ":" + std::to_string(last) +
                               " cannot be used (in use, or not an address of this machine); give "
                               "another address with --listen");
    }
  }
  const bool is_v6 = options.address.find(':') != std::string::npos;
  url = "http://" + (is_v6 ? "[" + options.address + "]" : options.address) + ":" +
        std::to_string(options.port) + "/";
}

PageServer::PageServer(PageContent& content, const PageServerOptions& options)
    : impl_(std::make_unique<Impl>(content, options)) {
  if (options.token.empty() && !is_loopback(options.address)) {
    throw std::runtime_error("--listen " + options.address +
                             " can be opened by other hosts: give a token with --token-file");
  }
  limit_files();
  impl_->set_up();
  impl_->bind();
  impl_->thread = std::thread([this] { impl_->server.listen_after_bind(); });
}

PageServer::~PageServer() {
  impl_->is_stopping = true;
  while (!impl_->server.is_running()) std::this_thread::yield();
  impl_->server.stop();
  impl_->thread.join();
}

const std::string& PageServer::url() const { return impl_->url; }

}  // namespace orchard::procs

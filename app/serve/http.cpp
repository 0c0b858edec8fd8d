// SPDX-License-Identifier: MIT
#include "app/serve/http.hpp"

#include <fmt/format.h>
#include <microhttpd.h>
#include <nettle/memops.h>
#include <sys/select.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "app/error.hpp"

namespace dampline::app {
namespace {

constexpr unsigned kTimeoutS = 30;  // of a connection on which nothing moves
constexpr std::size_t kConnectionBytes = 16384;
constexpr std::size_t kStreamBlock = 4096;
constexpr std::size_t kKeptEvents = 16;
constexpr unsigned kBacklog = 256;
constexpr const char* kCookie = "dampline_token";

// The page is its own files and nothing else; nobody puts it into a frame, and the address, which
// may hold the token, is told to nobody.
constexpr std::array<std::array<const char*, 2>, 5> kHeaders{{
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; "
     "base-uri 'none'; form-action 'self'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cache-Control", "no-store"},
}};

using Body = std::shared_ptr<const std::string>;

void release_body(void* body) { const std::unique_ptr<Body> owner{static_cast<Body*>(body)}; }

struct Destroy {
  void operator()(MHD_Response* response) const noexcept { MHD_destroy_response(response); }
};
using Response = std::unique_ptr<MHD_Response, Destroy>;

Response response_of(const Body& body) {
  auto owner = std::make_unique<Body>(body);
  Response out{MHD_create_response_from_buffer_with_free_callback_cls(
      body->size(), const_cast<char*>(body->data()),  // NOLINT(*-const-cast): only read
      &release_body, owner.get())};
  if (out) static_cast<void>(owner.release());
  return out;
}

void add_headers(MHD_Response* response, const char* type) {
  MHD_add_response_header(response, MHD_HTTP_HEADER_CONTENT_TYPE, type);
  for (const auto& [name, value] : kHeaders) MHD_add_response_header(response, name, value);
}

std::string_view value_of(MHD_Connection* connection, MHD_ValueKind kind, const char* name) {
  const char* value = MHD_lookup_connection_value(connection, kind, name);
  return value == nullptr ? std::string_view{} : std::string_view{value};
}

/// Takes as long whether the first character is wrong or the last.
bool same_secret(std::string_view given, const std::string& token) {
  return given.size() == token.size() && memeql_sec(given.data(), token.data(), token.size()) != 0;
}

/// Texts that the library reads and does not change.
std::vector<MHD_OptionItem> tls_options(TlsSettings& tls) {
  static std::string versions{"NORMAL:-VERS-ALL:+VERS-TLS1.3:+VERS-TLS1.2"};
  std::vector<MHD_OptionItem> out;
  if (tls.on())
    out = {{MHD_OPTION_HTTPS_MEM_CERT, 0, tls.certificate.data()},
           {MHD_OPTION_HTTPS_MEM_KEY, 0, tls.key.data()},
           {MHD_OPTION_HTTPS_PRIORITIES, 0, versions.data()}};
  if (!tls.client_authorities.empty())
    out.push_back({MHD_OPTION_HTTPS_MEM_TRUST, 0, tls.client_authorities.data()});
  out.push_back({MHD_OPTION_END, 0, nullptr});
  return out;
}

void log_nothing(void* /*context*/, const char* /*format*/, va_list /*arguments*/) {}

}  // namespace

HttpSettings http_settings(const NamedSetting& address, const NamedSetting& token_file,
                           const char* beside, TlsSettings tls) {
  HttpSettings out{parse_address(address.value, address.name), "", std::move(tls)};
  if (!token_file.value.empty()) out.token = read_token(token_file.value, token_file.name);
  if (!out.address.loopback && !out.knows_readers())
    throw UsageError{
        fmt::format("{}: {} can be reached by others, expected a loopback address, or {} beside it",
                    address.name, address.value, beside)};
  return out;
}

/// What the library calls.
struct HttpServer::Callbacks {
  static MHD_Result request(void* server, MHD_Connection* connection, const char* url,
                            const char* method, const char* /*version*/, const char* /*upload*/,
                            std::size_t* upload_bytes, void** context) {
    static char seen;
    const std::string_view verb{method};
    const bool reads = verb == MHD_HTTP_METHOD_GET || verb == MHD_HTTP_METHOD_HEAD;
    if (reads && *context == nullptr) {  // the headers are there, the end of the request not yet
      *context = &seen;
      return MHD_YES;
    }
    if (reads && *upload_bytes != 0) {  // nobody wants a body
      *upload_bytes = 0;
      return MHD_YES;
    }
    try {
      return static_cast<MHD_Result>(
          static_cast<HttpServer*>(server)->answer({connection, verb, url}));
    } catch (const std::exception&) {
      return MHD_NO;  // no memory: this connection ends
    }
  }
  static ssize_t stream(void* reader, std::uint64_t /*position*/, char* out, std::size_t most) {
    auto& of = *static_cast<Reader*>(reader);
    return of.server->fill(of, out, most);
  }
  static void forget(void* reader) {
    auto* of = static_cast<Reader*>(reader);
    of->server->readers_.erase(of);
  }
};

HttpServer::HttpServer(HttpSettings settings) : settings_{std::move(settings)} {
  unsigned flags = MHD_ALLOW_SUSPEND_RESUME;
  if (settings_.address.is_ipv6()) flags |= MHD_USE_IPv6;
  if (settings_.tls.on()) flags |= MHD_USE_TLS;
  std::vector<MHD_OptionItem> tls = tls_options(settings_.tls);
  const auto* address = reinterpret_cast<const sockaddr*>(&settings_.address.socket);
  errno = 0;
  daemon_ = MHD_start_daemon(
      flags, 0, nullptr, nullptr, &Callbacks::request, this, MHD_OPTION_EXTERNAL_LOGGER,
      &log_nothing, nullptr, MHD_OPTION_SOCK_ADDR, address, MHD_OPTION_CONNECTION_LIMIT,
      kMostConnections, MHD_OPTION_CONNECTION_TIMEOUT, kTimeoutS,
      MHD_OPTION_CONNECTION_MEMORY_LIMIT, kConnectionBytes, MHD_OPTION_STRICT_FOR_CLIENT, 1,
      MHD_OPTION_LISTEN_BACKLOG_SIZE, kBacklog, MHD_OPTION_ARRAY, tls.data(), MHD_OPTION_END);
  if (daemon_ == nullptr)
    throw RunError{
        fmt::format("cannot serve: {}", errno != 0 ? std::strerror(errno) : "no server")};
}

HttpServer::~HttpServer() {
  for (auto& [key, reader] : readers_)
    if (reader->asleep) MHD_resume_connection(reader->connection);
  MHD_stop_daemon(daemon_);
}

std::uint16_t HttpServer::port() const noexcept {
  const MHD_DaemonInfo* info = MHD_get_daemon_info(daemon_, MHD_DAEMON_INFO_BIND_PORT);
  return info == nullptr ? std::uint16_t{0} : info->port;
}

std::string HttpServer::where(const std::string& address) const {
  return fmt::format("{}://{}:{}/", settings_.tls.on() ? "https" : "http",
                     address.substr(0, address.rfind(':')), port());
}

void HttpServer::set(const char* path, const char* type, std::string body, unsigned status) {
  documents_.insert_or_assign(
      path, Document{type, status, std::make_shared<const std::string>(std::move(body))});
}

void HttpServer::send(std::string event, std::string whole) {
  whole_ = std::make_shared<const std::string>(std::move(whole));
  events_.push_back(std::make_shared<const std::string>(std::move(event)));
  if (events_.size() > kKeptEvents) {
    events_.pop_front();
    ++first_event_;
  }
  for (auto& [key, reader] : readers_) {
    if (!reader->asleep) continue;
    reader->asleep = false;
    MHD_resume_connection(reader->connection);
  }
}

void HttpServer::take_connection(int socket) {
  const auto* from = reinterpret_cast<const sockaddr*>(&settings_.address.socket);
  static_cast<void>(MHD_add_connection(daemon_, socket, from, sizeof(sockaddr_in)));
}

void HttpServer::turn(std::chrono::milliseconds most, int wake) {
  MHD_UNSIGNED_LONG_LONG due_ms = 0;
  auto wait_ms = static_cast<MHD_UNSIGNED_LONG_LONG>(most.count());
  if (MHD_get_timeout(daemon_, &due_ms) == MHD_YES) wait_ms = std::min(wait_ms, due_ms);
  // Not by epoll: there the library overlooks a reader that goes in the middle of a request.
  fd_set readable;
  fd_set writable;
  fd_set failed;
  FD_ZERO(&readable);
  FD_ZERO(&writable);
  FD_ZERO(&failed);
  int last = wake;
  MHD_get_fdset2(daemon_, &readable, &writable, &failed, &last, FD_SETSIZE);
  last = std::max(last, wake);
  FD_SET(wake, &readable);
  constexpr long kUsPerMs = 1000;
  timeval wait{static_cast<time_t>(wait_ms / 1000),
               static_cast<suseconds_t>(wait_ms % 1000) * kUsPerMs};
  if (::select(last + 1, &readable, &writable, &failed, &wait) < 0) {
    FD_ZERO(&readable);
    FD_ZERO(&writable);
    FD_ZERO(&failed);
  }
  MHD_run_from_select(daemon_, &readable, &writable, &failed);
}

int HttpServer::answer(const Request& request) {
  ++requests_;
  if (request.method != MHD_HTTP_METHOD_GET && request.method != MHD_HTTP_METHOD_HEAD)
    return refuse(request.connection, MHD_HTTP_METHOD_NOT_ALLOWED, "only GET and HEAD\n");
  if (!knows_host(request.connection))
    return refuse(request.connection, MHD_HTTP_MISDIRECTED_REQUEST,
                  "this is not the machine that Host names\n");
  if (!settings_.tls.client_authorities.empty() && !shows_certificate(request.connection))
    return refuse(request.connection, MHD_HTTP_FORBIDDEN,
                  "a certificate of a reader is needed that this server's authorities made\n");
  bool by_query = false;
  if (!has_token(request.connection, by_query))
    return refuse(request.connection, MHD_HTTP_UNAUTHORIZED,
                  "a token is needed: Authorization: Bearer TOKEN, or ?token=TOKEN\n");
  if (!stream_path_.empty() && request.path == stream_path_) return answer_stream(request);
  const auto found = documents_.find(request.path);
  if (found == documents_.end()) return answer_made(request, by_query);
  return reply(request.connection, found->second, by_query);
}

int HttpServer::answer_made(const Request& request, bool set_cookie) const {
  const auto value = [&](const char* name) {
    return std::string{value_of(request.connection, MHD_GET_ARGUMENT_KIND, name)};
  };
  std::optional<Made> made = maker_ ? maker_({request.path, value}) : std::nullopt;
  if (!made) return refuse(request.connection, MHD_HTTP_NOT_FOUND, "no such path\n");
  return reply(request.connection,
               {made->type, made->status,
                std::make_shared<const std::string>(std::move(made->body)), std::move(made->file)},
               set_cookie);
}

bool HttpServer::knows_host(MHD_Connection* connection) const {
  if (settings_.knows_readers()) return true;
  const std::string_view host = value_of(connection, MHD_HEADER_KIND, MHD_HTTP_HEADER_HOST);
  return host.empty() || names_loopback(host);
}

bool HttpServer::has_token(MHD_Connection* connection, bool& by_query) const {
  if (settings_.token.empty()) return true;
  constexpr std::string_view kBearer = "Bearer ";
  std::string_view header = value_of(connection, MHD_HEADER_KIND, MHD_HTTP_HEADER_AUTHORIZATION);
  if (header.starts_with(kBearer) && same_secret(header.substr(kBearer.size()), settings_.token))
    return true;
  if (same_secret(value_of(connection, MHD_COOKIE_KIND, kCookie), settings_.token)) return true;
  by_query = same_secret(value_of(connection, MHD_GET_ARGUMENT_KIND, "token"), settings_.token);
  return by_query;
}

int HttpServer::refuse(MHD_Connection* connection, unsigned status, const char* why) const {
  return reply(connection,
               {"text/plain; charset=utf-8", status, std::make_shared<const std::string>(why)},
               false);
}

int HttpServer::reply(MHD_Connection* connection, const Document& document, bool set_cookie) const {
  const Response response = response_of(document.body);
  if (!response) return MHD_NO;
  add_headers(response.get(), document.type);
  if (!document.file.empty())
    MHD_add_response_header(response.get(), MHD_HTTP_HEADER_CONTENT_DISPOSITION,
                            fmt::format("attachment; filename={}", document.file).c_str());
  if (document.status == MHD_HTTP_METHOD_NOT_ALLOWED)
    MHD_add_response_header(response.get(), MHD_HTTP_HEADER_ALLOW, "GET, HEAD");
  if (document.status == MHD_HTTP_UNAUTHORIZED)
    MHD_add_response_header(response.get(), MHD_HTTP_HEADER_WWW_AUTHENTICATE, "Bearer");
  if (set_cookie)  // for what the page itself asks for
    MHD_add_response_header(response.get(), MHD_HTTP_HEADER_SET_COOKIE,
                            fmt::format("{}={}; HttpOnly; SameSite=Strict; Path=/{}", kCookie,
                                        settings_.token, settings_.tls.on() ? "; Secure" : "")
                                .c_str());
  return MHD_queue_response(connection, document.status, response.get());
}

int HttpServer::answer_stream(const Request& request) {
  auto reader = std::make_unique<Reader>();
  reader->server = this;
  reader->connection = request.connection;
  reader->next = first_event_ + events_.size();
  reader->text = whole_;
  const Response response{MHD_create_response_from_callback(
      MHD_SIZE_UNKNOWN, kStreamBlock, &Callbacks::stream, reader.get(), &Callbacks::forget)};
  if (!response) return MHD_NO;
  Reader* key = reader.get();
  readers_.emplace(key, std::move(reader));
  add_headers(response.get(), "text/event-stream; charset=utf-8");
  return MHD_queue_response(request.connection, MHD_HTTP_OK, response.get());
}

/// False when there is nothing yet.
bool HttpServer::next_text(Reader& reader) const {
  const std::uint64_t end = first_event_ + events_.size();
  if (reader.next >= end) return false;
  const bool left_behind = reader.next < first_event_;
  reader.text = left_behind ? whole_ : events_[reader.next - first_event_];
  reader.next = left_behind ? end : reader.next + 1;
  reader.sent = 0;
  return true;
}

long HttpServer::fill(Reader& reader, char* out, std::size_t most) {
  const bool done = !reader.text || reader.sent == reader.text->size();
  if (done && !next_text(reader)) {
    reader.asleep = true;
    MHD_suspend_connection(reader.connection);
    return 0;
  }
  const std::size_t count = std::min(most, reader.text->size() - reader.sent);
  std::copy_n(reader.text->data() + reader.sent, count, out);
  reader.sent += count;
  return static_cast<long>(count);
}

}  // namespace dampline::app

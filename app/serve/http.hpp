// SPDX-License-Identifier: MIT
#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "app/serve/address.hpp"
#include "app/serve/tls.hpp"

struct MHD_Connection;
struct MHD_Daemon;
struct MHD_Response;

namespace dampline::app {

struct HttpSettings {
  Address address;
  std::string token;  ///< empty: none is asked for
  TlsSettings tls{};
  /// Not whoever reaches the address may read.
  [[nodiscard]] bool knows_readers() const noexcept {
    return !token.empty() || !tls.client_authorities.empty();
  }
};

/// What somebody set, and where: as errors call it.
struct NamedSetting {
  const std::string& value;
  const char* name;
};
/// Throws UsageError for a wrong address or token, and for an address that others can reach without
/// knowing its readers; `beside` names what makes it know them.
[[nodiscard]] HttpSettings http_settings(const NamedSetting& address,
                                         const NamedSetting& token_file, const char* beside,
                                         TlsSettings tls = {});

/// Documents and one stream of events over HTTP/1.1, read only, from the memory of this object. It
/// has no thread: whoever calls turn() is it, and calls the other methods. A reader that does not
/// keep up skips events; nobody waits for it.
class HttpServer {
 public:
  static constexpr unsigned kMostConnections = 320;

  /// Listens from now on. Throws RunError when the address cannot be had.
  explicit HttpServer(HttpSettings settings);
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  ~HttpServer();

  [[nodiscard]] std::uint16_t port() const noexcept;
  /// "http://127.0.0.1:9464/", of the address as it was given.
  [[nodiscard]] std::string where(const std::string& address) const;

  /// What a GET of `path` answers from now on. `path` and `type` are literals.
  void set(const char* path, const char* type, std::string body, unsigned status = 200);
  /// What is made when somebody asks: of a path that set() does not know, and of `?name=value`.
  struct Asked {
    std::string_view path;
    /// "" where the address has no such value.
    std::function<std::string(const char* name)> value;
  };
  struct Made {
    const char* type;
    std::string body;
    unsigned status{200};
    std::string file{};  ///< a name under which a browser is to save it
  };
  /// Nothing: there is no such path.
  using Maker = std::function<std::optional<Made>(const Asked&)>;
  void make_by(Maker maker) { maker_ = std::move(maker); }
  /// A path of its own that streams the events.
  void stream_at(const char* path) { stream_path_ = path; }
  /// An event for every reader of the stream. `whole`: what brings a new reader, or one that was
  /// left behind, up to date; good until the next call.
  void send(std::string event, std::string whole);

  /// A connection that is already there, a stream socket that does not block; it is the server's
  /// now.
  void take_connection(int socket);

  /// Serves for at most this time, or until the descriptor `wake` can be read.
  void turn(std::chrono::milliseconds most, int wake);

  [[nodiscard]] std::size_t readers() const noexcept { return readers_.size(); }
  [[nodiscard]] std::uint64_t requests() const noexcept { return requests_; }

 private:
  struct Document {
    const char* type;
    unsigned status;
    std::shared_ptr<const std::string> body;
    std::string file{};
  };
  struct Request {
    MHD_Connection* connection;
    std::string_view method;
    std::string_view path;
  };
  /// One reader of the stream.
  struct Reader {
    HttpServer* server{nullptr};
    MHD_Connection* connection{nullptr};
    std::shared_ptr<const std::string> text;  ///< what it is being sent
    std::size_t sent{0};
    std::uint64_t next{0};  ///< event
    bool asleep{false};
  };
  struct Callbacks;

  [[nodiscard]] int answer(const Request& request);
  [[nodiscard]] int answer_made(const Request& request, bool set_cookie) const;
  [[nodiscard]] int answer_stream(const Request& request);
  [[nodiscard]] int reply(MHD_Connection* connection, const Document& document,
                          bool set_cookie) const;
  [[nodiscard]] int refuse(MHD_Connection* connection, unsigned status, const char* why) const;
  [[nodiscard]] bool knows_host(MHD_Connection* connection) const;
  [[nodiscard]] bool has_token(MHD_Connection* connection, bool& by_query) const;
  [[nodiscard]] long fill(Reader& reader, char* out, std::size_t most);
  [[nodiscard]] bool next_text(Reader& reader) const;

  HttpSettings settings_;
  std::map<std::string, Document, std::less<>> documents_;
  Maker maker_;
  std::string stream_path_;
  std::deque<std::shared_ptr<const std::string>> events_;
  std::uint64_t first_event_{0};  ///< number of events_.front()
  std::shared_ptr<const std::string> whole_;
  std::map<Reader*, std::unique_ptr<Reader>> readers_;
  std::uint64_t requests_{0};
  MHD_Daemon* daemon_{nullptr};
};

}  // namespace dampline::app

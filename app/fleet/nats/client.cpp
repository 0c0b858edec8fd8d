// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <nats/nats.h>

#include <algorithm>
#include <array>
#include <utility>

#include "app/error.hpp"
#include "app/fleet/nats/nats.hpp"
#include "app/fleet/spool.hpp"

namespace dampline::app::fleet {
// Not without a name: what has one below holds these.
inline namespace client {

constexpr const char* kStream = "FLEET";
constexpr const char* kSubjects = "dl.state.>";
constexpr std::int64_t kReconnectMs = 500;
constexpr std::int64_t kConnectMs = 5000;

/// Of a C handle, which goes by its own function.
template <auto kDestroy>
struct Destroyed {
  void operator()(auto* handle) const { kDestroy(handle); }
};
using Options = std::unique_ptr<natsOptions, Destroyed<natsOptions_Destroy>>;
using Context = std::unique_ptr<jsCtx, Destroyed<jsCtx_Destroy>>;
using Subscription = std::unique_ptr<natsSubscription, Destroyed<natsSubscription_Destroy>>;
using Message = std::unique_ptr<natsMsg, Destroyed<natsMsg_Destroy>>;

void set(natsStatus status, const NatsAddress& address, const char* what) {
  if (status == NATS_OK) return;
  const char* more = nats_GetLastError(nullptr);
  throw UsageError{fmt::format("{}: {}: {}{}{}", address.url, what, natsStatus_GetText(status),
                               more == nullptr ? "" : ": ", more == nullptr ? "" : more)};
}

/// HOST of "tls://NAME@HOST:PORT".
std::string host_of(const std::string& url) {
  std::string host = url.substr(url.find("://") + 3);
  host.erase(0, host.find('@') + 1);
  const std::size_t end = host.starts_with('[') ? host.find(']') + 1 : host.find_first_of(":/");
  return host.substr(0, end);
}

std::vector<std::string> split(const std::string& urls) {
  std::vector<std::string> out;
  for (std::size_t begin = 0; begin <= urls.size();) {
    const std::size_t end = std::min(urls.find(',', begin), urls.size());
    if (end > begin) out.push_back(urls.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

void set_security(natsOptions* options, const NatsAddress& address,
                  const std::vector<std::string>& urls) {
  if (!address.creds_file.empty())
    set(natsOptions_SetUserCredentialsFromFiles(options, address.creds_file.c_str(), nullptr),
        address, "--creds");
  if (!address.ca_file.empty())
    set(natsOptions_LoadCATrustedCertificates(options, address.ca_file.c_str()), address, "--ca");
  if (address.cert_file.empty() != address.key_file.empty())
    throw UsageError{"--cert and --key: one without the other, expected both"};
  if (!address.cert_file.empty())
    set(natsOptions_LoadCertificatesChain(options, address.cert_file.c_str(),
                                          address.key_file.c_str()),
        address, "--cert, --key");
  const bool tls = std::any_of(urls.begin(), urls.end(),
                               [](const std::string& url) { return url.starts_with("tls://"); });
  if (tls || !address.ca_file.empty() || !address.cert_file.empty()) {
    set(natsOptions_SetSecure(options, true), address, "TLS");
    // The library checks no name by itself. Of several servers all have the first one's.
    set(natsOptions_SetExpectedHostname(options, host_of(urls.front()).c_str()), address, "TLS");
  }
}

Options options_of(const NatsAddress& address) {
  const std::vector<std::string> urls = split(address.url);
  if (urls.empty() || !std::all_of(urls.begin(), urls.end(), is_nats))
    throw UsageError{
        fmt::format("found \"{}\", expected nats://HOST:PORT or tls://HOST:PORT, several by commas",
                    address.url)};
  natsOptions* raw = nullptr;
  set(natsOptions_Create(&raw), address, "options");
  Options out{raw};
  std::vector<const char*> servers;
  servers.reserve(urls.size());
  for (const std::string& url : urls) servers.push_back(url.c_str());
  set(natsOptions_SetServers(raw, servers.data(), static_cast<int>(servers.size())), address,
      "address");
  set(natsOptions_SetName(raw, "dampline"), address, "name");
  set(natsOptions_SetMaxReconnect(raw, -1), address, "reconnect");
  set(natsOptions_SetReconnectWait(raw, kReconnectMs), address, "reconnect");
  set(natsOptions_SetTimeout(raw, kConnectMs), address, "timeout");
  set_security(raw, address, urls);
  return out;
}

/// A connection that comes back by itself.
class Connection {
 public:
  explicit Connection(Options options) : options_{std::move(options)} {
    // In place of the library's own, which prints.
    natsOptions_SetErrorHandler(
        options_.get(), [](natsConnection*, natsSubscription*, natsStatus, void*) {}, nullptr);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() {
    context_.reset();
    if (handle_ != nullptr) natsConnection_Destroy(handle_);
  }
  /// Empty: there is one.
  std::string open() {
    if (handle_ == nullptr) {
      const natsStatus status = natsConnection_Connect(&handle_, options_.get());
      if (status != NATS_OK) return text(status);
    }
    if (!context_) {
      jsCtx* context = nullptr;
      const natsStatus status = natsConnection_JetStream(&context, handle_, nullptr);
      if (status != NATS_OK) return text(status);
      context_.reset(context);
    }
    // While it is away libnats would keep messages and send them later, when they are stale.
    return natsConnection_Status(handle_) == NATS_CONN_STATUS_CONNECTED ? "" : "not connected";
  }
  [[nodiscard]] jsCtx* context() const { return context_.get(); }
  [[nodiscard]] natsConnection* handle() const { return handle_; }
  /// With what the server objected to, which the answer to a request does not say.
  [[nodiscard]] std::string text(natsStatus status) const {
    const char* objection = nullptr;
    if (handle_ == nullptr)
      objection = nats_GetLastError(nullptr);
    else if (natsConnection_GetLastError(handle_, &objection) == NATS_OK)
      objection = nullptr;
    std::string out = natsStatus_GetText(status);
    if (objection != nullptr && *objection != '\0') out += fmt::format(": {}", objection);
    return out;
  }

 private:
  Options options_;
  natsConnection* handle_{nullptr};
  Context context_;
};

}  // namespace client

bool has_nats() noexcept { return true; }

class NatsSender::Link {
 public:
  Link(const NatsAddress& address, const std::string& vehicle)
      : inbox_{"_INBOX." + segment_token(vehicle)}, connection_{prepare(address)} {}
  std::string send(const std::string& subject, std::string_view bytes,
                   std::chrono::milliseconds patience) {
    if (std::string why = connection_.open(); !why.empty()) return why;
    jsPubOptions options;
    jsPubOptions_Init(&options);
    options.MaxWait = patience.count();
    options.ExpectStream = kStream;
    jsPubAck* ack = nullptr;
    const natsStatus status = js_Publish(&ack, connection_.context(), subject.c_str(), bytes.data(),
                                         static_cast<int>(bytes.size()), &options, nullptr);
    jsPubAck_Destroy(ack);
    if (status == NATS_NO_RESPONDERS) return "no stream takes it";
    return status == NATS_OK ? "" : connection_.text(status);
  }

 private:
  Options prepare(const NatsAddress& address) const {
    Options out = options_of(address);
    set(natsOptions_SetCustomInboxPrefix(out.get(), inbox_.c_str()), address, "inbox");
    return out;
  }
  std::string inbox_;
  Connection connection_;
};

NatsSender::NatsSender(const NatsAddress& address, const std::string& vehicle)
    : link_{std::make_unique<Link>(address, vehicle)} {}
NatsSender::~NatsSender() = default;

std::string NatsSender::send(const Segment& segment, std::string_view bytes,
                             std::chrono::milliseconds patience) {
  return link_->send(subject_of(segment), bytes, patience);
}

class NatsReceiver::Link {
 public:
  Link(const NatsAddress& address, const std::string& consumer, bool again)
      : url_{address.url}, connection_{options_of(address)} {
    if (const std::string why = connection_.open(); !why.empty()) fail("cannot be reached: " + why);
    make_stream();
    if (again) {
      const natsStatus gone =
          js_DeleteConsumer(connection_.context(), kStream, consumer.c_str(), nullptr, nullptr);
      if (gone != NATS_NOT_FOUND) check(gone, "forgetting the consumer");
    }
    subscribe(consumer);
  }
  std::vector<NatsMessage> fetch(int most, std::chrono::milliseconds patience) {
    unconfirmed_.clear();
    natsMsgList list{};
    const natsStatus status =
        natsSubscription_Fetch(&list, subscription_.get(), most, patience.count(), nullptr);
    if (const std::string why = connection_.open(); !why.empty()) fail(why);
    if (status != NATS_TIMEOUT) check(status, "fetching");
    std::vector<NatsMessage> out;
    for (int i = 0; i < list.Count; ++i) {
      unconfirmed_.emplace_back(std::exchange(list.Msgs[i], nullptr));
      natsMsg* message = unconfirmed_.back().get();
      out.push_back(
          {natsMsg_GetSubject(message),
           {natsMsg_GetData(message), static_cast<std::size_t>(natsMsg_GetDataLength(message))}});
    }
    natsMsgList_Destroy(&list);
    return out;
  }
  void confirm() {
    // What does not arrive is sent again, and known then.
    for (const Message& message : unconfirmed_) natsMsg_Ack(message.get(), nullptr);
    natsConnection_FlushTimeout(connection_.handle(), kConnectMs);
    unconfirmed_.clear();
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw NatsError{fmt::format("{}: {}", url_, why)};
  }
  void check(natsStatus status, const char* what) const {
    if (status != NATS_OK) fail(fmt::format("{}: {}", what, connection_.text(status)));
  }
  void make_stream() {
    constexpr std::int64_t kDayNs = 86'400'000'000'000;
    jsStreamInfo* info = nullptr;
    const natsStatus known =
        js_GetStreamInfo(&info, connection_.context(), kStream, nullptr, nullptr);
    jsStreamInfo_Destroy(info);
    if (known == NATS_OK) return;
    if (known != NATS_NOT_FOUND) check(known, "stream FLEET");
    jsStreamConfig config;
    jsStreamConfig_Init(&config);
    std::array<const char*, 1> subjects{kSubjects};
    config.Name = kStream;
    config.Subjects = subjects.data();
    config.SubjectsLen = 1;
    config.Storage = js_FileStorage;
    config.MaxMsgsPerSubject = 1;
    config.MaxAge = 30 * kDayNs;  // a collector comes before
    check(js_AddStream(nullptr, connection_.context(), &config, nullptr, nullptr),
          "making stream FLEET");
  }
  void subscribe(const std::string& consumer) {
    constexpr std::int64_t kAckWaitNs = 60'000'000'000;
    jsSubOptions options;
    jsSubOptions_Init(&options);
    options.Stream = kStream;
    options.Config.AckPolicy = js_AckExplicit;
    options.Config.AckWait = kAckWaitNs;
    natsSubscription* raw = nullptr;
    check(js_PullSubscribe(&raw, connection_.context(), kSubjects, consumer.c_str(), nullptr,
                           &options, nullptr),
          "subscribing");
    subscription_.reset(raw);
  }

  std::string url_;
  Connection connection_;
  Subscription subscription_;
  std::vector<Message> unconfirmed_;
};

NatsReceiver::NatsReceiver(const NatsAddress& address, const std::string& consumer, bool again)
    : link_{std::make_unique<Link>(address, consumer, again)} {}
NatsReceiver::~NatsReceiver() = default;
std::vector<NatsMessage> NatsReceiver::fetch(int most, std::chrono::milliseconds patience) {
  return link_->fetch(most, patience);
}
void NatsReceiver::confirm() { link_->confirm(); }

}  // namespace dampline::app::fleet

// SPDX-License-Identifier: MIT
#include "tests/fuzz/readers.hpp"

#include <linux/can.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/error.hpp"
#include "app/live/digital_lines.hpp"
#include "app/run/json.hpp"
#include "app/run/provenance.hpp"
#include "app/run/state.hpp"
#include "app/run/tables.hpp"
#include "app/serve/http.hpp"
#include "dampline/sample/assembler.hpp"
#include "drivers/blackbox/source.hpp"
#include "drivers/candump/source.hpp"
#include "drivers/checksum/crc32c.hpp"
#include "drivers/csv/reader.hpp"
#include "drivers/dbc/channel.hpp"
#include "drivers/dbc/parse.hpp"
#include "drivers/gpiod/edges.hpp"
#include "drivers/mat/whole.hpp"
#include "drivers/record/frames.hpp"
#include "drivers/record/rows.hpp"
#include "drivers/socketcan/link.hpp"
#include "drivers/socketcan/message.hpp"

namespace dampline::fuzz {
namespace {

/// What must hold of whatever was read.
void require(bool holds) {
  if (!holds) std::abort();
}

std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The bytes as a file in memory, for readers that open one by its name.
class MemoryFile {
 public:
  explicit MemoryFile(Bytes bytes) : file_{::memfd_create("fuzz", MFD_CLOEXEC)} {
    require(file_ >= 0);
    require(::write(file_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
    path_ = "/proc/self/fd/" + std::to_string(file_);
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { ::close(file_); }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  int file_;
  std::string path_;
};

/// Calls a reader that refuses by throwing.
template <class Read>
void refusing(Read read) {
  try {
    read();
  } catch (const app::RunError&) {
  } catch (const app::UsageError&) {
  }
}

/// The first byte, which chooses what is done with the others.
std::uint8_t take_choice(Bytes& bytes) {
  if (bytes.empty()) return 0;
  const std::uint8_t choice = bytes.front();
  bytes = bytes.subspan(1);
  return choice;
}

void read_dbc(Bytes bytes) {
  const auto dbc = drivers::parse_dbc(text_of(bytes), "fuzz.dbc");
  if (!dbc) return;
  for (const drivers::DbcMessage& message : dbc.value().messages)
    for (const drivers::DbcSignal& signal : message.signals) {
      const std::string name = message.name + "." + signal.name;
      const auto channel = drivers::channel_from(dbc.value(), name, "");
      if (!channel) continue;
      AssemblerConfig config;
      config.channels.fill(channel.value());
      if (!SampleAssembler::check(config)) continue;
      const auto assembler = std::make_unique<SampleAssembler>(config);
      CanFrame frame;
      frame.id = message.id;
      frame.extended = message.extended;
      frame.length = 8;
      for (int i = 0; i < 20; ++i) {
        frame.time_ns += 3'333'333;
        frame.data[0] = static_cast<std::uint8_t>(i);
        assembler->push(frame);
      }
    }
}

void read_candump(Bytes bytes) {
  const bool skip = (take_choice(bytes) & 1U) != 0U;
  const MemoryFile file{bytes};
  auto source = drivers::CandumpSource::open({file.path(), skip, {}});
  if (!source) return;
  std::array<CanFrame, 64> frames;
  std::int64_t newest_ns = 0;
  for (auto count = source.value()->read(frames); count; count = source.value()->read(frames))
    for (std::size_t i = 0; i < count.value(); ++i) {
      require(frames[i].time_ns >= newest_ns);
      require(frames[i].length <= frames[i].data.size());
      newest_ns = frames[i].time_ns;
      fmt::memory_buffer line;
      drivers::append_candump(line, frames[i], "can0");
    }
}

/// A recording of frames in any format, found by its content.
void read_recording(Bytes bytes) {
  const bool skip = (take_choice(bytes) & 1U) != 0U;
  const MemoryFile file{bytes};
  auto source = drivers::open_frames({.path = file.path(),
                                      .skip_bad_lines = skip,
                                      .interfaces = {},
                                      .untimed = drivers::UntimedFrames{0x123, false, 0.01}});
  if (!source) return;
  std::array<CanFrame, 64> frames;
  std::int64_t newest_ns = 0;
  for (auto count = source.value()->read(frames); count; count = source.value()->read(frames))
    for (std::size_t i = 0; i < count.value(); ++i) {
      require(frames[i].time_ns >= newest_ns);
      require(frames[i].length <= frames[i].data.size());
      require(frames[i].interface_index < source.value()->interfaces().size());
      newest_ns = frames[i].time_ns;
    }
}

void read_csv(Bytes bytes) {
  const std::uint8_t choice = take_choice(bytes);
  const MemoryFile file{bytes};
  drivers::RowFileConfig config;
  config.path = file.path();
  config.skip_bad_lines = (choice & 1U) != 0U;
  if ((choice & 2U) != 0U) config.time_column.clear();
  config.optional = {"time_s", "deflection_m", "force_n"};
  auto reader = drivers::CsvReader::open(config);
  if (!reader) return;
  std::array<double, 3> row{};
  double newest_s = -HUGE_VAL;
  for (auto rows = reader.value()->read(row); rows; rows = reader.value()->read(row)) {
    if (rows.value() == 0 || config.time_column.empty() || !reader.value()->has("time_s")) continue;
    require(row[0] > newest_s);
    newest_s = row[0];
  }
}

/// Rows of arrays, found by their content.
void read_arrays(Bytes bytes) {
  const std::uint8_t choice = take_choice(bytes);
  const MemoryFile file{bytes};
  drivers::RowFileConfig config;
  config.path = file.path();
  config.skip_bad_lines = (choice & 1U) != 0U;
  config.optional = {"time_s", "deflection_m", "force_n"};
  auto reader = drivers::open_rows(config);
  if (!reader) return;
  std::array<double, 3> row{};
  while (reader.value()->read(row)) require(reader.value()->health().rows <= bytes.size());
}

/// Frames, or measured signals.
void read_mdf(Bytes bytes) {
  read_recording(bytes);
  read_arrays(bytes);
}

/// What is looked at before libmatio reads the file.
void read_mat(Bytes bytes) {
  const MemoryFile file{bytes};
  const auto opened = drivers::RandomFile::open(file.path());
  if (opened) static_cast<void>(drivers::fault_of_mat(*opened.value()));
}

/// The input holds what a file does without its checksums, which no fuzzer finds: they are set
/// here. A byte of the choice says whether.
void read_blackbox(Bytes bytes) {
  using namespace drivers;
  const std::uint8_t choice = take_choice(bytes);
  std::vector<std::uint8_t> file{bytes.begin(), bytes.end()};
  BlackboxHeader header;
  if ((choice & 1U) != 0U) {
    header.interface_count = choice >> 5U;
    file.insert(file.begin(), kRecordsAt, std::uint8_t{0});
    encode_header(header, std::span<std::uint8_t, kRecordsAt>{file.data(), kRecordsAt});
    const auto seed = header.checksum_seed();
    for (std::size_t at = kRecordsAt; at + kRecordHead + kRecordTail <= file.size();) {
      const std::size_t whole = kRecordHead + file[at + kRecordLengthAt] + kRecordTail;
      if (at + whole > file.size()) break;
      std::copy(kRecordMagic.begin(), kRecordMagic.end(),
                file.begin() + static_cast<std::ptrdiff_t>(at));
      const std::uint32_t sum = crc32c({&file[at], whole - kRecordTail}, seed);
      put_little_endian(&file[at + whole - kRecordTail], sum);
      at += whole;
    }
  }
  const MemoryFile memory{file};
  auto source = BlackboxSource::open({memory.path(), {}});
  if (!source) return;
  std::array<CanFrame, 64> frames;
  std::int64_t newest_ns = std::numeric_limits<std::int64_t>::min();
  for (auto count = source.value()->read(frames); count; count = source.value()->read(frames)) {
    for (std::size_t i = 0; i < count.value(); ++i) {
      require(frames[i].time_ns >= newest_ns && frames[i].length <= frames[i].data.size());
      newest_ns = frames[i].time_ns;
    }
    for (hal::Event event; source.value()->next_event(event);) require(event.time_ns != 1);
  }
}

/// state.dls without the frame around its payload, which is put there.
void read_state(Bytes bytes) {
  static const auto kStatistics = std::make_unique<Statistics>();
  static const auto kSum = std::make_unique<Statistics>();
  static const std::string kEmpty = app::encode_state(Statistics{});
  const bool framed = (take_choice(bytes) & 1U) != 0U;
  std::string file{text_of(bytes)};
  if (framed) {
    constexpr std::size_t kHead = 40;
    constexpr std::size_t kPayloadBytesAt = 32;
    std::string payload = std::move(file);
    file = kEmpty.substr(0, kHead);
    // What is not given is as in an empty state, so that short inputs are whole ones.
    if (payload.size() + kHead + 4 < kEmpty.size())
      payload += kEmpty.substr(kHead + payload.size(), kEmpty.size() - kHead - payload.size() - 4);
    drivers::put_little_endian(reinterpret_cast<std::uint8_t*>(&file[kPayloadBytesAt]),
                               std::uint64_t{payload.size()});
    file += payload;
    std::array<std::uint8_t, 4> sum{};
    drivers::put_little_endian(
        sum.data(),
        drivers::crc32c({reinterpret_cast<const std::uint8_t*>(file.data()), file.size()}));
    file.append(sum.begin(), sum.end());
  }
  refusing([&] {
    const app::StateAbout about = app::decode_state(file, "fuzz.dls", *kStatistics);
    const auto kind = app::is_light_state(file) ? app::StateKind::kLight : app::StateKind::kFull;
    const bool bare = about.moving_mass_kg == 0.0;  // of version 1, which says nothing more
    require(bare || app::encode_state(*kStatistics, about, kind).size() == file.size());
    kSum->header = kStatistics->header;
    app::merge_state(*kSum, *kStatistics, "fuzz.dls");
  });
}

void read_config(Bytes bytes) {
  refusing([&] {
    const app::Config config = app::parse_config(text_of(bytes), "fuzz.toml");
    const std::string shown = app::show_config(config);
    require(app::show_config(app::parse_config(shown, "shown.toml")) == shown);
  });
}

void read_provenance(Bytes bytes) {
  refusing([&] { static_cast<void>(app::read_provenance(text_of(bytes), "run.toml")); });
}

void read_parameters(Bytes bytes) {
  refusing([&] {
    const app::RunResult result = app::from_json(text_of(bytes), "parameters.json");
    require(!app::to_json(result).empty());
  });
}

void read_phase(Bytes bytes) {
  refusing([&] { static_cast<void>(app::read_phase(text_of(bytes), "phase.json")); });
}

void read_tables(Bytes bytes) {
  const std::uint8_t choice = take_choice(bytes);
  const std::string_view text = text_of(bytes);
  const std::string origin = "table.csv";
  const auto both = [&](const auto& rows) { static_cast<void>(app::to_csv(rows)); };
  refusing([&] {
    switch (choice % 12U) {
      case 0:
        return both(app::read_table<app::ResidualRow>(text, origin));
      case 1:
        return both(app::read_table<app::LoopRow>(text, origin));
      case 2:
        return both(app::read_table<app::LawRow>(text, origin));
      case 3:
        return both(app::read_table<app::MotionRow>(text, origin));
      case 4:
        return both(app::read_table<app::ForceRow>(text, origin));
      case 5:
        return both(app::read_table<app::Excluded>(text, origin));
      case 6:
        return both(app::read_table<app::RunEvent>(text, origin));
      case 7:
        return both(app::read_table<app::LatenessRow>(text, origin));
      case 8:
        return both(app::read_densities(text, origin));
      case 9:
        return both(app::read_convergence(text, origin));
      case 10:
        return both(app::read_prediction(text, origin));
      default: {
        app::RunResult result;
        result.methods.resize(choice / 64U);
        return app::read_curve(text, origin, result);
      }
    }
  });
}

/// Frames of 72 bytes as a socket gives them, each through the decoding of a truck's channels.
void read_frames(Bytes bytes) {
  AssemblerConfig config;
  for (std::size_t c = 0; c < kChannels; ++c) {
    config.channels[c].id = static_cast<std::uint32_t>(0x100 + c);
    config.channels[c].accel = {.start_bit = 0, .length = 12, .is_signed = true, .scale = 0.01};
    config.channels[c].has_counter = c != 1;
    config.channels[c].counter = {.start_bit = 16, .length = 8};
  }
  const auto assembler = std::make_unique<SampleAssembler>(config);
  std::int64_t time_ns = 0;
  std::int64_t tick = -1;
  constexpr std::size_t kHead = 3;
  while (bytes.size() >= kHead + sizeof(canfd_frame)) {
    canfd_frame wire{};
    std::memcpy(&wire, bytes.data() + kHead, sizeof(wire));
    time_ns += (std::int64_t{bytes[1]} - 2) << (bytes[2] % 48U);
    time_ns = std::clamp<std::int64_t>(time_ns, 0, std::int64_t{1} << 60U);
    CanFrame frame;
    if (drivers::from_wire(wire, bytes[0], frame)) {
      frame.time_ns = time_ns;
      require(frame.length <= frame.data.size());
      canfd_frame back{};
      static_cast<void>(drivers::to_wire(frame, back));
      if (frame.error) require(drivers::error_events(frame).count <= 3);
      assembler->push(frame);
    }
    for (Sample sample; assembler->pop(sample); tick = sample.tick) require(sample.tick > tick);
    bytes = bytes.subspan(kHead + sizeof(canfd_frame));
  }
  assembler->flush();
  for (Sample sample; assembler->pop(sample); tick = sample.tick) require(sample.tick > tick);
  static_cast<void>(ledger_of(assembler->counts(), 0));
}

/// What lies beside a frame: control messages with the kernel's stamps and drops.
void read_control(Bytes bytes) {
  struct alignas(cmsghdr) Control {
    std::array<std::uint8_t, 128> bytes{};
  } control;
  std::copy_n(bytes.begin(), std::min(bytes.size(), control.bytes.size()), control.bytes.begin());
  msghdr header{};
  header.msg_control = control.bytes.data();
  header.msg_controllen = std::min(bytes.size(), control.bytes.size());
  static_cast<void>(drivers::read_info(header));
}

void read_links(Bytes bytes) {
  for (const drivers::LinkState& link : drivers::parse_links(std::as_bytes(bytes)))
    static_cast<void>(drivers::link_warnings(link));
}

/// [gpio] edges and lamp as text, and edges as the kernel tells them.
void read_gpio(Bytes bytes) {
  const std::uint8_t choice = take_choice(bytes);
  if (choice % 3U < 2U)
    return refusing([&, text = std::string{text_of(bytes)}] {
      static_cast<void>(choice % 3U == 0 ? app::parse_edge_line(text) : app::parse_lamp_line(text));
    });
  drivers::EdgeConfig config;
  config.lines = {{1, false, true, true}, {2, true, true, false}};
  drivers::EdgeLedger ledger{config, choice < 128};
  for (; bytes.size() >= 16; bytes = bytes.subspan(16)) {
    drivers::KernelEdge edge;
    edge.line = bytes[0] % 2U;
    edge.rising = bytes[1] % 2U == 0U;
    edge.monotonic_ns = drivers::get_little_endian<std::int64_t>(bytes.data() + 2);
    if (bytes[10] != 0) edge.number = drivers::get_little_endian<std::uint32_t>(bytes.data() + 11);
    static_cast<void>(ledger.enter(edge));
  }
}

constexpr std::string_view kToken = "0123456789abcdef";

/// %30 as 0, as an address may have it.
std::string unescaped(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned value = 0;
    const char* const digits = text.data() + i + 1;
    const bool escaped = text[i] == '%' && i + 2 < text.size() &&
                         std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2;
    out += escaped ? static_cast<char>(value) : text[i];
    if (escaped) i += 2;
  }
  return out;
}

/// Bytes of a reader of the page, as they come over a connection: requests, whole or not. The first
/// byte: whether a token is asked for, and in how many parts they come.
void read_http(Bytes bytes) {
  const std::uint8_t choice = take_choice(bytes);
  const std::string token{choice % 2U == 0 ? std::string_view{} : kToken};
  app::HttpServer server{{app::parse_address("127.0.0.1:0", ""), token, {}}};
  server.set("/live.json", "application/json", "secret\n");
  server.stream_at("/events");
  server.send("event: now\n\n", "event: now\n\n");
  std::array<int, 2> ends{};
  require(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) == 0);
  server.take_connection(ends[0]);
  const std::size_t part = 1 + bytes.size() / (1 + choice / 64U);
  std::string heard;
  std::array<char, 4096> answer{};
  const auto turn = [&] {
    server.turn(std::chrono::milliseconds{0}, ends[1]);
    for (ssize_t n = 0; (n = ::recv(ends[1], answer.data(), answer.size(), 0)) > 0;)
      heard.append(answer.data(), static_cast<std::size_t>(n));
  };
  for (std::size_t at = 0; at < bytes.size(); at += part) {
    const Bytes now = bytes.subspan(at, std::min(part, bytes.size() - at));
    static_cast<void>(::send(ends[1], now.data(), now.size(), MSG_NOSIGNAL));
    turn();
    turn();
  }
  ::shutdown(ends[1], SHUT_WR);
  turn();
  turn();
  ::shutdown(ends[1], SHUT_RDWR);
  turn();
  ::close(ends[1]);
  const bool knows = unescaped(text_of(bytes)).find(kToken) != std::string::npos;
  require(token.empty() || knows || heard.find("secret") == std::string::npos);
}

constexpr std::array kReaders{Reader{"dbc", read_dbc},
                              Reader{"candump", read_candump},
                              Reader{"screen", read_recording},
                              Reader{"asc", read_recording},
                              Reader{"trc", read_recording},
                              Reader{"blf", read_recording},
                              Reader{"mdf", read_mdf},
                              Reader{"mat", read_mat},
                              Reader{"compressed", read_recording},
                              Reader{"csv", read_csv},
                              Reader{"npy", read_arrays},
                              Reader{"blackbox", read_blackbox},
                              Reader{"state", read_state},
                              Reader{"config", read_config},
                              Reader{"provenance", read_provenance},
                              Reader{"parameters", read_parameters},
                              Reader{"phase", read_phase},
                              Reader{"tables", read_tables},
                              Reader{"frames", read_frames},
                              Reader{"control", read_control},
                              Reader{"links", read_links},
                              Reader{"gpio", read_gpio},
                              Reader{"http", read_http}};

}  // namespace

std::span<const Reader> readers() { return kReaders; }

}  // namespace dampline::fuzz

// SPDX-License-Identifier: MIT
#include "drivers/record/format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <span>
#include <vector>

#include "drivers/bytes/byte_stream.hpp"
#include "drivers/bytes/spool.hpp"
#include "drivers/mdf/reader.hpp"
#include "drivers/text/cursor.hpp"

namespace dampline::drivers {
namespace {

using namespace std::string_view_literals;

constexpr std::size_t kHead = std::size_t{64} * 1024;
constexpr int kLinesOfHead = 200;
constexpr std::size_t kHdf5Behind = 512;  // the block that MATLAB 7.3 puts before it
constexpr std::string_view kHdf5Mark = "\x89HDF\r\n\x1A\n";

struct Mark {
  std::string_view bytes;
  RecordFormat format;
};
constexpr std::array kMarks{Mark{"LOGG"sv, RecordFormat::kBlf},
                            Mark{"UnFinMF "sv, RecordFormat::kMdf4},
                            Mark{"MDF     4"sv, RecordFormat::kMdf4},
                            Mark{"MDF     "sv, RecordFormat::kMdf3},
                            Mark{"\x93NUMPY"sv, RecordFormat::kNpy},
                            Mark{kHdf5Mark, RecordFormat::kHdf5},
                            Mark{"MATLAB 5.0 MAT-file"sv, RecordFormat::kMat},
                            Mark{"MATLAB 7.3 MAT-file"sv, RecordFormat::kHdf5},
                            Mark{"\xD0\xCF\x11\xE0"sv, RecordFormat::kOldExcel},
                            Mark{"TDSm"sv, RecordFormat::kTdms},
                            Mark{"\x0A\x0D\x0D\x0A"sv, RecordFormat::kPcap},
                            Mark{"\xD4\xC3\xB2\xA1"sv, RecordFormat::kPcap},
                            Mark{"\xA1\xB2\xC3\xD4"sv, RecordFormat::kPcap},
                            Mark{"\x4D\x3C\xB2\xA1"sv, RecordFormat::kPcap},
                            Mark{"PAR1"sv, RecordFormat::kParquet},
                            Mark{"\xFD"
                                 "7zXZ"sv,
                                 RecordFormat::kXz},
                            Mark{"BZh"sv, RecordFormat::kBzip2}};

bool is_hex(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'F') || (c >= 'a' && c <= 'f');
}

bool all_hex(std::string_view word, std::size_t most) {
  return !word.empty() && word.size() <= most && std::all_of(word.begin(), word.end(), is_hex);
}

/// "(1600000000.123456) can0 123#", or nothing.
bool is_candump(std::string_view line) {
  if (!line.starts_with('(')) return false;
  const std::size_t end = line.find(')');
  if (end == std::string_view::npos) return false;
  std::string_view rest = line.substr(end + 1);
  static_cast<void>(take_word(rest));
  const std::string_view frame = take_word(rest);
  const std::size_t hash = frame.find('#');
  return hash != std::string_view::npos && all_hex(frame.substr(0, hash), 8);
}

/// "[8]" or "[08]", and not the unit of a table's "Force A [N]".
bool is_length(std::string_view word) {
  return word.size() >= 3 && word.size() <= 4 && word.front() == '[' && word.back() == ']' &&
         word.substr(1, word.size() - 2).find_first_not_of("0123456789") == std::string_view::npos;
}

/// " (000.001000)  can0  RX - -  123   [8]  11 22": an identifier, then a length in brackets.
bool is_candump_screen(std::string_view line) {
  while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
  if (line.starts_with('(')) {
    const std::size_t end = line.find(')');
    if (end == std::string_view::npos) return false;
    line.remove_prefix(end + 1);
  }
  std::string_view before = take_word(line);
  for (int words = 0; words < 5 && !before.empty(); ++words) {
    const std::string_view word = take_word(line);
    if (is_length(word)) return words > 0 && all_hex(before, 8);
    before = word;
  }
  return false;
}

bool is_asc(std::string_view line) {
  return line.starts_with("date ") || line.starts_with("base hex") ||
         line.starts_with("base dec") || line.starts_with("Begin Triggerblock") ||
         line.starts_with("Begin TriggerBlock");
}

bool is_trc(std::string_view line) {
  return line.starts_with(";$FILEVERSION=") ||
         (line.starts_with(';') && line.find("   Start time: ") != std::string_view::npos);
}

RecordFormat of_line(std::string_view line) {
  if (is_candump(line)) return RecordFormat::kCandump;
  if (is_candump_screen(line)) return RecordFormat::kCandumpScreen;
  if (is_asc(line)) return RecordFormat::kAsc;
  return is_trc(line) ? RecordFormat::kTrc : RecordFormat::kTable;
}

RecordFormat of_text(std::string_view head) {
  head = without_byte_order_mark(head);
  for (int lines = 0; lines < kLinesOfHead && !head.empty(); ++lines) {
    const std::size_t end = std::min(head.find('\n'), head.size());
    std::string_view line = head.substr(0, end);
    head.remove_prefix(std::min(end + 1, head.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (const RecordFormat found = of_line(line); found != RecordFormat::kTable) return found;
  }
  return RecordFormat::kTable;
}

/// Of a zip file: the names of NumPy's arrays end in .npy. The first name begins at byte 30.
RecordFormat of_zip(std::string_view head) {
  constexpr std::size_t kName = 30;
  if (head.size() < kName) return RecordFormat::kOtherZip;
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(head[i]); };
  const std::size_t length = byte(26) + 256U * byte(27);
  const std::string_view name = head.substr(kName, length);
  return name.ends_with(".npy") ? RecordFormat::kNpz : RecordFormat::kOtherZip;
}

bool is_binary(std::string_view head) {
  return std::any_of(head.begin(), head.end(), [](char c) { return c == '\0'; });
}

}  // namespace

RecordFormat format_of(std::string_view head) noexcept {
  if (head.empty()) return RecordFormat::kEmpty;
  for (const Mark& mark : kMarks)
    if (head.starts_with(mark.bytes)) return mark.format;
  if (head.starts_with("PK\x03\x04")) return of_zip(head);
  if (head.size() > kHdf5Behind && head.substr(kHdf5Behind).starts_with(kHdf5Mark))
    return RecordFormat::kHdf5;
  const RecordFormat text = of_text(head);
  return text == RecordFormat::kTable && is_binary(head) ? RecordFormat::kUnknown : text;
}

Outcome<std::string> read_head(const std::string& path) {
  constexpr std::chrono::milliseconds kPause{300};
  Outcome<ByteStream> opened = ByteStream::open(spooled_before(path));
  if (!opened) return opened.failure();
  ByteStream& stream = opened.value();
  std::string head(kHead, '\0');
  std::size_t count = 0;
  while (head.size() - count >= 4) {
    const auto part = stream.read(std::span{head}.subspan(count));
    count += part.count;
    if (part.status == ByteStream::Status::kError)
      return Failure{stream.error(), stream.error_text()};
    if (part.status == ByteStream::Status::kEnd) break;
    if (part.status == ByteStream::Status::kBytes) continue;
    const std::string_view text{head.data(), count};
    if (const std::size_t lines = text.rfind('\n');
        lines != std::string_view::npos && holds_frames(format_of(text.substr(0, lines + 1))))
      break;
    const auto something = stream.wait(kPause);
    if (!something && count > 0 && text.find('\n') != std::string_view::npos) break;
  }
  head.resize(count);
  return head;
}

Outcome<RecordFormat> detect_format(const std::string& path) {
  const Outcome<std::string> head = read_head(path);
  if (!head) return head.failure();
  const RecordFormat format = format_of(head.value());
  return format == RecordFormat::kMdf4 && !mdf_holds_frames(path) ? RecordFormat::kMdf4Rows
                                                                  : format;
}

bool holds_frames(RecordFormat format) noexcept {
  return format >= RecordFormat::kCandump && format <= RecordFormat::kMdf4;
}

bool holds_rows(RecordFormat format) noexcept {
  return format >= RecordFormat::kTable && format <= RecordFormat::kMdf4Rows;
}

std::string_view name_of(RecordFormat format) noexcept {
  switch (format) {
    case RecordFormat::kEmpty:
      return "nothing: it is empty";
    case RecordFormat::kUnknown:
      return "binary data";
    case RecordFormat::kCandump:
      return "a candump log";
    case RecordFormat::kCandumpScreen:
      return "what candump prints";
    case RecordFormat::kAsc:
      return "a Vector ASC file";
    case RecordFormat::kTrc:
      return "a PEAK TRC file";
    case RecordFormat::kBlf:
      return "a Vector BLF file";
    case RecordFormat::kMdf4:
      return "an MDF4 file of a CAN bus";
    case RecordFormat::kTable:
      return "text in columns";
    case RecordFormat::kNpy:
      return "a NumPy array";
    case RecordFormat::kNpz:
      return "NumPy arrays";
    case RecordFormat::kMat:
      return "a MAT file";
    case RecordFormat::kHdf5:
      return "an HDF5 file";
    case RecordFormat::kMdf4Rows:
      return "an MDF4 file of measured signals";
    case RecordFormat::kMdf3:
      return "an MDF file of version 3";
    case RecordFormat::kOtherZip:
      return "a zip file (a spreadsheet, or an archive)";
    case RecordFormat::kOldExcel:
      return "an Excel file";
    case RecordFormat::kTdms:
      return "a LabVIEW TDMS file";
    case RecordFormat::kPcap:
      return "a packet capture";
    case RecordFormat::kParquet:
      return "a Parquet file";
    case RecordFormat::kXz:
      return "xz-compressed data";
    case RecordFormat::kBzip2:
      return "bzip2-compressed data";
  }
  return "binary data";
}

std::string_view way_out_of(RecordFormat format) noexcept {
  switch (format) {
    case RecordFormat::kMdf3:
    case RecordFormat::kTdms:
    case RecordFormat::kParquet:
      return "export it as CSV or MAT with the program that wrote it";
    case RecordFormat::kOtherZip:
    case RecordFormat::kOldExcel:
      return "save the sheet as CSV, or unpack the archive";
    case RecordFormat::kPcap:
      return "convert it to a candump log (tshark, canutils-pcap)";
    case RecordFormat::kXz:
      return "decompress it first: xz -dc FILE | dampline identify -";
    case RecordFormat::kBzip2:
      return "decompress it first: bzip2 -dc FILE | dampline identify -";
    default:
      return {};
  }
}

}  // namespace dampline::drivers

// SPDX-License-Identifier: MIT
#include "drivers/npy/reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "drivers/bytes/spool.hpp"
#include "drivers/npy/zip.hpp"
#include "drivers/record/column_file.hpp"

namespace dampline::drivers {
namespace {

constexpr std::string_view kSuffix = ".npy";

std::unique_ptr<Decompressor> inflater(bool deflated) {
  auto out = deflated ? make_deflate() : nullptr;
  if (out) out->restart();
  return out;
}

/// "", "1": the name of a plain array's column.
std::string column_name(const std::string& array, std::size_t column, std::size_t columns) {
  if (array.empty()) return std::to_string(column + 1);
  return columns == 1 ? array : fmt::format("{}_{}", array, column + 1);
}

}  // namespace

Outcome<std::unique_ptr<RecordedRows>> NpyReader::open(const RowFileConfig& config,
                                                       RecordFormat format) {
  const auto path = spooled(config.path);
  if (!path) return path.failure();
  auto file = RandomFile::open(path.value());
  if (!file) return file.failure();
  std::unique_ptr<NpyReader> out{new NpyReader{config}};
  const auto taken = format == RecordFormat::kNpz
                         ? out->take_archive(file.value())
                         : out->take_array(file.value(), 0, file.value()->size(), false, {});
  if (!taken) return taken.failure();
  out->keep_longest();
  if (out->strands_.empty())
    return Failure{Errc::kMalformed, fmt::format("{}: holds no array of numbers", config.path)};
  if (const auto chosen = out->choose_columns(config, config.path); !chosen)
    return chosen.failure();
  return std::unique_ptr<RecordedRows>{std::move(out)};
}

Outcome<bool> NpyReader::take_archive(const std::shared_ptr<RandomFile>& file) {
  const auto members = zip_members(*file, name_);
  if (!members) return members.failure();
  for (const ZipMember& member : members.value()) {
    std::string name = member.name;
    if (!name.ends_with(kSuffix)) continue;
    name.resize(name.size() - kSuffix.size());
    // What holds no numbers (text, objects) is left out here; alone it would be refused.
    static_cast<void>(take_array(file, member.begin, member.packed_bytes, member.deflated, name));
  }
  return true;
}

Outcome<bool> NpyReader::take_array(const std::shared_ptr<RandomFile>& file, std::uint64_t begin,
                                    std::uint64_t bytes, bool deflated, const std::string& name) {
  FileRange range{file, begin, bytes, inflater(deflated)};
  const auto head = range.look(kLongestNpyHeader + 12);
  std::string why;
  const auto header = read_npy_header({head.data(), head.size()}, why);
  const auto refuse = [&](std::string_view what) {
    return Failure{Errc::kMalformed,
                   fmt::format("{}: the array {}{}", name_, name.empty() ? "" : name + " ", what)};
  };
  if (!header) return refuse(why);
  if (header->shape.empty()) return refuse("is a single number");
  const bool structured = !header->fields.front().name.empty();
  const std::uint64_t width = header->shape.size() == 2 ? header->shape[1] : 1;
  if (structured && width != 1) return refuse("has several structures a row");
  if (width == 0 || width > kMostColumns) return refuse("has no column, or more than 1024");
  const std::uint64_t rows = header->shape[0];
  const auto columns = static_cast<std::size_t>(width);
  if (header->by_column && columns > 1) {
    if (deflated) return refuse("is deflated and lies by columns: store it by rows");
    const std::uint64_t stride = header->item_bytes * std::min(rows, bytes);
    for (std::size_t c = 0; c < columns; ++c) {
      const std::uint64_t offset = std::min(bytes, header->header_bytes + c * stride);
      NpyField field{column_name(name, c, columns), 0, header->fields.front().type};
      strands_.push_back({FileRange{file, begin + offset, std::min(stride, bytes - offset)},
                          header->item_bytes,
                          rows,
                          {std::move(field)}});
    }
    return true;
  }
  range.drop(header->header_bytes);
  Strand strand{std::move(range), header->item_bytes * columns, rows, header->fields};
  if (strand.row_bytes > FileRange::kLongest) return refuse("has too long rows");
  if (!structured) {
    strand.columns.clear();
    for (std::size_t c = 0; c < columns; ++c)
      strand.columns.push_back(
          {column_name(name, c, columns), c * header->item_bytes, header->fields.front().type});
  }
  strands_.push_back(std::move(strand));
  return true;
}

// Arrays of another length are settings, not columns.
void NpyReader::keep_longest() {
  for (const Strand& strand : strands_) rows_ = std::max(rows_, strand.rows);
  std::erase_if(strands_, [this](const Strand& strand) { return strand.rows != rows_; });
  for (const Strand& strand : strands_)
    for (const NpyField& column : strand.columns) {
      header_.push_back(column.name);
      kinds_.push_back(column.type.kind);
    }
  first_s_.resize(header_.size());
}

bool NpyReader::read_row(std::span<double> row) noexcept {
  std::fill(row.begin(), row.end(), std::numeric_limits<double>::quiet_NaN());
  std::size_t column = 0;
  for (Strand& strand : strands_) {
    const auto bytes = strand.range.look(strand.row_bytes);
    if (bytes.size() < strand.row_bytes) return false;
    for (const NpyField& field : strand.columns) {
      const std::size_t place = place_of_[column];
      if (place != kUnused) {
        double number = field.type.read(bytes.data() + field.offset);
        if (kinds_[column] == NpyType::Kind::kTime) {
          if (!first_s_[column]) first_s_[column] = number;
          number -= *first_s_[column];
        }
        row[place] = number;
      }
      ++column;
    }
    strand.range.drop(strand.row_bytes);
  }
  return true;
}

NpyReader::Step NpyReader::read_one(std::span<double> row) noexcept {
  if (row_ == rows_ || !read_row(row)) {
    health_.truncated = row_ < rows_;
    if (health_.rows > 0) return stop(Errc::kEndOfStream, {});
    return stop(Errc::kMalformed, fmt::format("{}: holds no whole row", name_));
  }
  health_.line = ++row_;
  const std::string fault = check_time(row);
  if (fault.empty()) return Step::kRow;
  return bad_row(fmt::format("{}: row {}: {}", name_, row_, fault));
}

}  // namespace dampline::drivers

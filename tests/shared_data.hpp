// SPDX-License-Identifier: MIT
#pragma once
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace dampline::test {

/// A file among the measured records: DAMPLINE_SHARED_DATA, or the folder beside the project.
inline std::filesystem::path shared_data(const std::string& name = "") {
  const char* set = std::getenv("DAMPLINE_SHARED_DATA");
  const std::filesystem::path folder{set != nullptr ? set : DAMPLINE_SOURCE_DIR "/../shared/data"};
  return name.empty() ? folder : folder / name;
}

/// Numbers of a CSV file, row by row; the first line is its header.
inline std::vector<std::vector<double>> numbers(const std::filesystem::path& file) {
  std::vector<std::vector<double>> out;
  std::ifstream stream{file};
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::vector<double> row;
    for (const char* at = line.c_str(); *at != '\0';) {
      char* end = nullptr;
      row.push_back(std::strtod(at, &end));
      at = *end == ',' ? end + 1 : end;
    }
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace dampline::test

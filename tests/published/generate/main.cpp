// SPDX-License-Identifier: MIT
// connection_header FOLDER: writes the headers with the connection coefficients.
#include <fstream>
#include <iostream>
#include <string>

#include "tests/published/generate/connection_header.hpp"
#include "tests/published/generate/product.hpp"

namespace {

bool write(const std::string& path, const std::string& text) {
  std::ofstream file{path};
  file << text;
  file.close();
  if (!file) std::cerr << path << ": cannot be written\n";
  return static_cast<bool>(file);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: connection_header FOLDER\n";
    return 2;
  }
  const std::string folder = argv[1];
  const bool ok = write(folder + "/daubechies.hpp", dampline::generate::connection_header()) &&
                  write(folder + "/product_table.hpp", dampline::generate::product_header());
  return ok ? 0 : 1;
}

// SPDX-License-Identifier: MIT
// connection_header FILE: writes the header with the connection coefficients.
#include <fstream>
#include <iostream>

#include "generate/connection_header.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: connection_header FILE\n";
    return 2;
  }
  std::ofstream file{argv[1]};
  file << dampline::generate::connection_header();
  file.close();
  if (!file) std::cerr << argv[1] << ": cannot be written\n";
  return file ? 0 : 1;
}

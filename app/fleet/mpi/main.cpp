// SPDX-License-Identifier: MIT
// `dampline archive` under mpirun: the same work by as many processes as there are ranks.
#include <fmt/format.h>
#include <mpi.h>

#include <array>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/error.hpp"
#include "app/program.hpp"
#include "app/verbs/archive.hpp"

namespace dampline::app {
namespace {

constexpr int kFirst = 0;
constexpr int kNodeTag = 1;

void check(int code, const char* what) {
  if (code == MPI_SUCCESS) return;
  std::array<char, MPI_MAX_ERROR_STRING> text{};
  int length = 0;
  MPI_Error_string(code, text.data(), &length);
  throw RunError{fmt::format("MPI: {}: {}", what, text.data())};
}

int fits(std::size_t bytes) {
  if (bytes > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw RunError{"MPI: a message of more than 2 GiB"};
  return static_cast<int>(bytes);
}

void send(const std::string& bytes) {
  check(MPI_Send(bytes.data(), fits(bytes.size()), MPI_BYTE, kFirst, kNodeTag, MPI_COMM_WORLD),
        "a node cannot be sent");
}

std::string receive(int rank) {
  MPI_Status status;
  int size = 0;
  check(MPI_Probe(rank, kNodeTag, MPI_COMM_WORLD, &status), "no node came");
  check(MPI_Get_count(&status, MPI_BYTE, &size), "a node has no size");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  check(MPI_Recv(bytes.data(), size, MPI_BYTE, rank, kNodeTag, MPI_COMM_WORLD, &status),
        "a node cannot be received");
  return bytes;
}

/// From the first rank to all.
void broadcast(std::string& text) {
  std::uint64_t size = text.size();
  check(MPI_Bcast(&size, 1, MPI_UINT64_T, kFirst, MPI_COMM_WORLD), "a size cannot be told");
  text.resize(size);
  check(MPI_Bcast(text.data(), fits(text.size()), MPI_BYTE, kFirst, MPI_COMM_WORLD),
        "a list cannot be told");
}

/// A rank of MPI_COMM_WORLD. Chunk number c is merged by rank c % ranks; each sends its chunks in
/// their order, a count and then the nodes, and the first rank takes them in the order of all.
class Ranks final : public fleet::Workers {
 public:
  Ranks() {
    int rank = 0;
    int count = 1;
    check(MPI_Comm_rank(MPI_COMM_WORLD, &rank), "no rank");
    check(MPI_Comm_size(MPI_COMM_WORLD, &count), "no size");
    part_ = {static_cast<std::size_t>(rank), static_cast<std::size_t>(count)};
  }

  fleet::Part part() const override { return part_; }

  fleet::Tally gather(const fleet::Tally& own) override {
    const std::array<std::uint64_t, 5> mine{own.logs, own.made, own.before, own.set_aside,
                                            own.bytes};
    std::array<std::uint64_t, 5> all{};
    fleet::Tally out;
    check(MPI_Reduce(mine.data(), all.data(), mine.size(), MPI_UINT64_T, MPI_SUM, kFirst,
                     MPI_COMM_WORLD),
          "the counts do not come together");
    check(MPI_Reduce(&own.seconds, &out.seconds, 1, MPI_DOUBLE, MPI_MAX, kFirst, MPI_COMM_WORLD),
          "the times do not come together");
    out.logs = all[0];
    out.made = all[1];
    out.before = all[2];
    out.set_aside = all[3];
    out.bytes = all[4];
    return out;
  }

  fleet::NextChunk chunks(std::span<const fleet::Leaf> leaves, int /*jobs*/) override {
    std::string list;
    for (const fleet::Leaf& leaf : leaves) list += leaf.file.string() + '\0';
    broadcast(list);
    return [this, leaves, chunk = std::size_t{0}]() mutable {
      const std::size_t number = chunk++;
      const auto rank = number % part_.of;
      return rank == 0 ? fleet::merge_chunk(chunk_at(leaves, number))
                       : receive_chunk(static_cast<int>(rank));
    };
  }

  void help() override {
    std::string list;
    broadcast(list);
    std::vector<fleet::Leaf> leaves;
    for (std::size_t at = 0; at < list.size(); at = list.find('\0', at) + 1) {
      fleet::Leaf& leaf = leaves.emplace_back();
      leaf.file = list.c_str() + at;
      leaf.read = fleet::file_reader(leaf.file);
    }
    const std::size_t chunk = fleet::chunk_of(leaves.size());
    for (std::size_t number = part_.part; number * chunk < leaves.size(); number += part_.of)
      send_chunk(fleet::merge_chunk(chunk_at(leaves, number)));
  }

 private:
  static std::span<const fleet::Leaf> chunk_at(std::span<const fleet::Leaf> leaves,
                                               std::size_t number) {
    const std::size_t chunk = fleet::chunk_of(leaves.size());
    const std::size_t begin = number * chunk;
    return leaves.subspan(begin, std::min(chunk, leaves.size() - begin));
  }
  static void send_chunk(const std::vector<fleet::Node>& nodes) {
    send(std::to_string(nodes.size()));
    for (const fleet::Node& node : nodes) {
      StateAbout about;
      about.segments = static_cast<std::uint32_t>(node.rank) + 1;  // nothing else is wanted of it
      send(encode_state(*node.sums, about));
    }
  }
  static std::vector<fleet::Node> receive_chunk(int rank) {
    std::vector<fleet::Node> nodes(std::stoul(receive(rank)));
    for (fleet::Node& node : nodes) {
      node.sums = std::make_unique<Statistics>();
      const StateAbout about =
          decode_state(receive(rank), fmt::format("rank {}", rank), *node.sums);
      node.rank = static_cast<int>(about.segments) - 1;
    }
    return nodes;
  }

  fleet::Part part_;
};

/// One rank that failed leaves the others waiting: all of them end.
int act(const ArchiveFlags& flags) {
  check(MPI_Init(nullptr, nullptr), "cannot be started");
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  constexpr int kRunFailed = 1;
  constexpr int kUsage = 2;
  const int code = exit_code([&] {
    Ranks ranks;
    return archive(flags, ranks);
  });
  if (code == kRunFailed || code == kUsage) MPI_Abort(MPI_COMM_WORLD, code);
  MPI_Finalize();
  return code;
}

}  // namespace
}  // namespace dampline::app

int main(int argc, char** argv) {
  CLI::App program{"Many logs into states and one merged run, by the ranks of MPI"};
  program.name("dampline archive");
  dampline::app::ArchiveFlags flags;
  dampline::app::add_archive_options(program, flags);
  return dampline::app::run(
      program, [&] { return dampline::app::act(flags); }, argc, argv);
}

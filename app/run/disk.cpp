// SPDX-License-Identifier: MIT
#include "app/run/disk.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>  // renameat2()
#include <cstring>
#include <system_error>
#include <utility>

#include "app/error.hpp"

namespace dampline::app {
namespace {

namespace fs = std::filesystem;

constexpr int kAttempts = 100;  // names that exist already; one is too many
constexpr int kNewFile = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;

std::string unforeseen() {
  std::uint64_t number = 0;
  // Does not wait for entropy after a boot; O_EXCL holds all the same.
  if (::getrandom(&number, sizeof(number), GRND_INSECURE) != sizeof(number))
    number = static_cast<std::uint64_t>(::getpid());
  return fmt::format("{:016x}", number);
}

void write_all(int descriptor, std::string_view content, const fs::path& file) {
  while (!content.empty()) {
    const ssize_t count = ::write(descriptor, content.data(), content.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail_io(file, "write", errno);
    content.remove_prefix(static_cast<std::size_t>(count));
  }
}

bool fill(Descriptor out, std::string_view content, const fs::path& file) {
  static_cast<void>(::flock(out.get(), LOCK_EX | LOCK_NB));
  write_all(out.get(), content, file);
  if (::fsync(out.get()) != 0) fail_io(file, "write", errno);
  if (out.close() != 0) fail_io(file, "write", errno);
  return true;
}

}  // namespace

Descriptor::Descriptor(Descriptor&& other) noexcept : number_{std::exchange(other.number_, -1)} {}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  static_cast<void>(close());
  number_ = std::exchange(other.number_, -1);
  return *this;
}

int Descriptor::close() noexcept {
  const int number = std::exchange(number_, -1);
  return number < 0 ? 0 : ::close(number);
}

void fail_io(const fs::path& path, std::string_view action, int error) {
  throw IoError{fmt::format("{}: cannot {}: {}", path.string(), action, std::strerror(error)),
                error};
}

Descriptor open_directory(const fs::path& folder) {
  Descriptor out{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (out.get() < 0) fail_io(folder, "open", errno);
  return out;
}

void write_new(int folder, const std::string& name, std::string_view content,
               const fs::path& shown) {
  Descriptor out{::openat(folder, name.c_str(), kNewFile, 0666)};
  if (out.get() < 0) fail_io(shown / name, "create", errno);
  try {
    fill(std::move(out), content, shown / name);
  } catch (const IoError&) {
    ::unlinkat(folder, name.c_str(), 0);
    throw;
  }
}

void write_file(const fs::path& file, std::string_view content) {
  const fs::path parent = file.has_parent_path() ? file.parent_path() : fs::path{"."};
  const Descriptor folder{::open(parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (folder.get() < 0) fail_io(file, "write", errno);
  const std::string staged = partial_name();
  write_new(folder.get(), staged, content, parent);
  if (::renameat(folder.get(), staged.c_str(), folder.get(), file.filename().c_str()) != 0) {
    const int error = errno;
    ::unlinkat(folder.get(), staged.c_str(), 0);
    fail_io(file, "write", error);
  }
  ::fsync(folder.get());
}

std::string partial_name() { return std::string{kPartial} + unforeseen(); }

fs::path make_partial(const fs::path& parent, const std::string& stem, Descriptor& lock) {
  const Descriptor folder{::open(parent.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC)};
  if (folder.get() < 0) fail_io(parent, "write into it", errno);
  for (int attempt = 0;; ++attempt) {
    const std::string name = stem + unforeseen();
    if (::mkdirat(folder.get(), name.c_str(), 0777) == 0) {
      lock = Descriptor{
          ::openat(folder.get(), name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC)};
      if (lock.get() < 0) {
        const int error = errno;
        ::unlinkat(folder.get(), name.c_str(), AT_REMOVEDIR);
        fail_io(parent / name, "open", error);
      }
      static_cast<void>(::flock(lock.get(), LOCK_EX | LOCK_NB));
      return parent / name;
    }
    if (errno != EEXIST || attempt == kAttempts) fail_io(parent, "write into it", errno);
  }
}

std::vector<std::filesystem::path> files_below(
    const std::filesystem::path& folder,
    const std::function<bool(const std::filesystem::path&)>& pass_over) {
  std::vector<std::filesystem::path> out;
  std::error_code error;
  std::filesystem::recursive_directory_iterator at{folder, error};
  for (; !error && at != std::filesystem::recursive_directory_iterator{}; at.increment(error)) {
    if (pass_over && pass_over(at->path())) {
      if (at->is_directory(error)) at.disable_recursion_pending();
    } else if (at->is_regular_file(error)) {
      out.push_back(at->path());
    }
  }
  if (error)
    throw RunError{fmt::format("{}: cannot be read: {}", folder.string(), error.message())};
  return out;
}

void remove_stale(const fs::path& parent, const std::string& stem) noexcept {
  std::error_code error;
  for (fs::directory_iterator at{parent, error}; !error && at != fs::directory_iterator{};
       at.increment(error)) {
    const std::string name = at->path().filename();
    if (!name.starts_with(stem) || name.find(kPartial) == std::string::npos) continue;
    const Descriptor held{
        ::open(at->path().c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)};
    if (held.get() < 0 || ::flock(held.get(), LOCK_EX | LOCK_NB) != 0) continue;
    std::error_code ignored;
    fs::remove_all(at->path(), ignored);
  }
}

// NOLINTNEXTLINE(misc-no-recursion): as deep as the tree
bool link_tree(const fs::path& from, const fs::path& to) {
  std::error_code error;
  if (fs::is_directory(fs::symlink_status(from, error)) && !error) {
    bool whole = fs::create_directory(to, from, error);
    for (fs::directory_iterator at{from, error}; whole && !error && at != fs::directory_iterator{};
         at.increment(error))
      whole = link_tree(at->path(), to / at->path().filename());
    if (whole && !error) sync_directory(to);
    if (whole && !error) return true;
  } else if (::linkat(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), 0) == 0) {
    return true;
  }
  fs::remove_all(to, error);
  return false;
}

void exchange(const fs::path& parent, const std::string& first, const std::string& second) {
  const Descriptor folder{::open(parent.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC)};
  if (folder.get() < 0) fail_io(parent, "open", errno);
  const auto rename = [at = folder.get()](const std::string& from, const std::string& to,
                                          unsigned how) {
    return ::renameat2(at, from.c_str(), at, to.c_str(), how);
  };
  if (rename(first, second, RENAME_EXCHANGE) == 0) return;
  if (errno != EINVAL && errno != ENOSYS) fail_io(parent / first, "replace", errno);
  const std::string aside = first + ".replaced";
  if (rename(first, aside, 0) != 0) fail_io(parent / first, "replace", errno);
  if (rename(second, first, 0) != 0) {
    const int error = errno;
    rename(aside, first, 0);
    fail_io(parent / first, "replace", error);
  }
  if (rename(aside, second, 0) != 0) fail_io(parent / aside, "rename", errno);
}

bool same_mount(const fs::path& one, const fs::path& other) {
  struct statx a {};
  struct statx b {};
  const auto look = [](const fs::path& path, struct statx& out) {
    return ::statx(AT_FDCWD, path.c_str(), 0, STATX_BASIC_STATS | STATX_MNT_ID, &out) == 0;
  };
  if (!look(one, a) || !look(other, b)) return false;
  const bool known = (a.stx_mask & b.stx_mask & STATX_MNT_ID) != 0;
  return a.stx_dev_major == b.stx_dev_major && a.stx_dev_minor == b.stx_dev_minor &&
         (!known || a.stx_mnt_id == b.stx_mnt_id);
}

void sync_directory(const fs::path& folder) noexcept {
  const Descriptor handle{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (handle.get() >= 0) ::fsync(handle.get());
}

}  // namespace dampline::app

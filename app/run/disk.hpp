// SPDX-License-Identifier: MIT
// Files and directories that appear whole or not at all.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace dampline::app {

/// A file descriptor that is closed on every way out.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) noexcept : number_{number} {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor() { static_cast<void>(close()); }
  [[nodiscard]] int get() const noexcept { return number_; }
  /// What close(2) returns: it may report that the disk is full.
  int close() noexcept;

 private:
  int number_;
};

/// Throws IoError "PATH: cannot ACTION: reason".
[[noreturn]] void fail_io(const std::filesystem::path& path, std::string_view action, int error);

/// Throws IoError.
[[nodiscard]] Descriptor open_directory(const std::filesystem::path& folder);

/// A new file in an opened directory, on the disk when this returns. Whatever had that name before
/// is an error, a link included; what was written by half is removed. `shown` is what errors call
/// the directory. Throws IoError.
void write_new(int folder, const std::string& name, std::string_view content,
               const std::filesystem::path& shown);

/// Writes a file so that a reader sees the old content or the whole new content, and so that the
/// new one survives a power cut. Throws IoError naming the file and the reason; leaves no partial
/// file.
void write_file(const std::filesystem::path& file, std::string_view content);

/// What is being written has a name that begins with this, goes on with what nobody can foresee,
/// and is locked by who writes it.
inline constexpr std::string_view kPartial = ".partial-";

/// A name of that kind.
[[nodiscard]] std::string partial_name();

/// A new directory `parent`/`stem`NUMBER, locked while `lock` is open. Throws IoError.
[[nodiscard]] std::filesystem::path make_partial(const std::filesystem::path& parent,
                                                 const std::string& stem, Descriptor& lock);

/// The regular files below a folder, to any depth; what `pass_over` says yes to, a folder or a
/// file, is not looked at. Throws RunError for a folder that cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> files_below(
    const std::filesystem::path& folder,
    const std::function<bool(const std::filesystem::path&)>& pass_over = {});

/// Removes what was being written under names that begin so, and nobody writes any more.
void remove_stale(const std::filesystem::path& parent, const std::string& stem) noexcept;

/// The same content under another name, without a copy: hard links in directories of their own.
/// False when the file system has none; nothing is left of it then.
[[nodiscard]] bool link_tree(const std::filesystem::path& from, const std::filesystem::path& to);

/// Exchanges two directories of one folder in one step; where the file system cannot, in two,
/// between which the first one has the name `first`.replaced. Throws IoError.
void exchange(const std::filesystem::path& parent, const std::string& first,
              const std::string& second);

/// Whether a rename leads from one directory to the other.
[[nodiscard]] bool same_mount(const std::filesystem::path& one, const std::filesystem::path& other);

void sync_directory(const std::filesystem::path& folder) noexcept;

}  // namespace dampline::app

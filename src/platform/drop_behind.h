#pragma once
/// Files of gigabytes that are written from beginning to end.
#include <cstdint>
#include <filesystem>
#include <memory>

namespace rubble::platform {

/// Starts to store what was written to a file, and takes it from the page cache of the system once it is
/// stored, from a thread of its own. Pages of the cache are then used again: the first use of new ones costs
/// more than the copy into them, most of all on virtual machines, and other files lose theirs. Has no effect
/// on content, on what is no regular file, and on systems other than Linux.
class DropBehind {
 public:
  /// The file exists, and lives longer than this.
  explicit DropBehind(const std::filesystem::path& file);
  ~DropBehind();
  DropBehind(const DropBehind&) = delete;
  DropBehind& operator=(const DropBehind&) = delete;

  /// Everything up to there was given to the system [bytes].
  void written(std::uint64_t end);

 private:
  struct Worker;
  std::unique_ptr<Worker> worker_;  ///< from the first window on that was written
  std::filesystem::path file_;
};

}  // namespace rubble::platform

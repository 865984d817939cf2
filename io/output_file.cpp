#include "io/output_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <random>
#include <system_error>

#if !defined(_WIN32)
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#define RUBBLE_HAS_FLOCK 1
#endif

#include <rubble/error.h>

#include "platform/system.h"

namespace rubble::io {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWritable = "a file that can be written";

/// May it be written, without a change to it?
bool isWritable(const fs::path& file) {
  std::FILE* const out = platform::openFile(file, "ab");
  return out && std::fclose(out) == 0;
}

/// An empty file of a name that nothing has, in a folder; "" and errno if none can be made there.
fs::path freshFile(const fs::path& folder, const std::string& ending) {
  std::random_device random;
  for (int tries = 0; tries < 100; ++tries) {
    fs::path path = folder / (".rubble-" + std::to_string(random()) + ending);
    if (platform::createFile(path)) return path;
    if (errno != EEXIST) break;
  }
  return {};
}

}  // namespace

NewFile::NewFile(const std::string& file) : file_(file), path_(file) {
  std::error_code none;
  const fs::file_status status = fs::status(file_, none);
  if (fs::is_directory(status)) throw Error(file_, kWritable, "a folder");
  const bool isThere = fs::exists(status), isLink = fs::is_symlink(fs::symlink_status(file_, none));
  // a device, a pipe, or a link to what is not there yet
  if (isThere ? !fs::is_regular_file(status) : isLink) return;
  // where a link leads to
  const fs::path target = isLink ? fs::canonical(file_, none) : fs::path(file_);
  if (isThere && !isWritable(target)) throw Error(file_, kWritable, std::strerror(errno));
  fs::path fresh = freshFile(target.parent_path(), target.extension().string());
  if (fresh.empty()) {
    // one that may be written in a folder that may not
    if (isThere) return;
    throw Error(file_, kWritable, std::strerror(errno));
  }
  try {
    path_ = fresh.string();
    target_ = target;
  } catch (...) {
    fs::remove(fresh, none);
    throw;
  }
  fresh_ = std::move(fresh);
}

NewFile::~NewFile() {
  std::error_code none;
  if (!target_.empty()) fs::remove(fresh_, none);
}

void NewFile::keep() {
  if (target_.empty()) return;
  std::error_code wrong;
  if (const fs::file_status before = fs::status(target_, wrong); fs::exists(before))
    fs::permissions(fresh_, before.permissions(), wrong);
  fs::rename(fresh_, target_, wrong);
  if (wrong) throw Error(file_, kWritable, wrong.message());
  target_.clear();
}

OutputFile::OutputFile(const std::string& file) : name_(file), stream_(name_.path(), std::ios::binary) {
  if (!stream_) throw Error(file, kWritable, std::strerror(errno));
}

void OutputFile::finish() {
  stream_.close();
  if (!stream_) throw Error(name_.file(), "to be written in full", std::strerror(errno));
  name_.keep();
}

#if defined(RUBBLE_HAS_FLOCK)
FileLock::FileLock(const std::string& file)
    : descriptor_(open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) throw Error(file, kWritable, std::strerror(errno));
  if (flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  close(descriptor_);
  throw Error(file, "a file that nothing else is being recorded to",
              "one that another recording is being written to");
}
FileLock::~FileLock() { close(descriptor_); }
#else
FileLock::FileLock(const std::string&) {}
FileLock::~FileLock() = default;
#endif

}  // namespace rubble::io

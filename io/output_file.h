#pragma once
/// Files that are written completely or not at all: content goes to a new file next to the wanted one, which
/// is renamed at the end.
#include <filesystem>
#include <fstream>
#include <string>

namespace rubble::io {

/// The name of a file that is being written. What is no plain file (a device, a pipe) is never replaced: it
/// is written as it is.
class NewFile {
 public:
  /// Throws Error if the file cannot be written.
  explicit NewFile(const std::string& file);
  /// Without keep() the file is as it was before, or is not there.
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  const std::string& file() const { return file_; }
  /// Where the content goes; it ends like the file.
  const std::string& path() const { return path_; }
  /// Throws Error if the content cannot take the name.
  void keep();

 private:
  std::string file_, path_;
  std::filesystem::path target_;  ///< what keep() replaces; empty: path_ is the file itself
  std::filesystem::path fresh_;   ///< path_, so that its end needs no memory
};

/// A stream into such a file.
class OutputFile {
 public:
  explicit OutputFile(const std::string& file);
  std::ostream& stream() { return stream_; }
  /// Where the content goes until it is finished.
  const std::string& path() const { return name_.path(); }
  /// Throws Error if anything could not be written.
  void finish();

 private:
  NewFile name_;
  std::ofstream stream_;
};

/// Keeps others that lock it from writing a file. One that was killed holds none.
class FileLock {
 public:
  /// Throws Error if another one holds it, or the file cannot be written.
  explicit FileLock(const std::string& file);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace rubble::io

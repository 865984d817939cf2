#pragma once
/// What a program asks of its system. Unknown answers are 0, false or "".
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <string>

namespace rubble::platform {

/// Memory of this process that is in use [bytes].
std::size_t residentBytes();
/// Name of the processor.
std::string processorName();
/// Name, release and processor type of the system: "Linux 6.1 x86_64".
std::string systemName();
/// Whether what is written to the file is shown on a terminal.
bool isTerminal(std::FILE* file);
std::tm utc(std::time_t time);
/// A file that takes everything and keeps nothing.
extern const char* const kNullFile;
/// std::fopen for any name.
std::FILE* openFile(const std::filesystem::path& file, const char* mode);
/// Makes an empty file; false, and errno EEXIST, if there is one.
bool createFile(const std::filesystem::path& file);

}  // namespace rubble::platform

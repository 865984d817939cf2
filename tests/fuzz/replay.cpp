/// Replays a corpus without a fuzzer: the program takes files and folders, and tests each file as one input.
#include <algorithm>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "tests/fuzz/target.h"

namespace fs = std::filesystem;

namespace {

std::vector<fs::path> filesOf(int argc, char** argv) {
  std::vector<fs::path> files;
  for (int i = 1; i < argc; ++i) {
    if (!fs::is_directory(argv[i])) {
      files.emplace_back(argv[i]);
      continue;
    }
    for (const fs::directory_entry& entry : fs::directory_iterator(argv[i]))
      if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

bool rubble::fuzz::isReplay() { return true; }

int main(int argc, char** argv) try {
  const std::vector<fs::path> files = filesOf(argc, argv);
  if (files.empty()) {
    std::fprintf(stderr, "usage: %s FILE_OR_FOLDER...; found no file\n", argv[0]);
    return 2;
  }
  for (const fs::path& file : files) {
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    std::printf("%s: %zu bytes\n", file.filename().c_str(), bytes.size());
    std::fflush(stdout);
    rubble::fuzz::testInput({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "fuzz: an exception that is no rubble::Error: %s\n", error.what());
  return 1;
}

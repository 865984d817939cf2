#include "apps/cli/layer_files.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <type_traits>

#include <fmt/format.h>
#include <rubble/error.h>

#include "apps/cli/output.h"
#include "io/output_file.h"
#include "io/picture.h"

namespace rubble::cli {
namespace {

static_assert(std::endian::native == std::endian::little, "all three formats are little-endian here");

void writeBytes(std::ostream& out, const void* data, std::size_t bytes) {
  out.write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes));
}
template <class T> void writeNumber(std::ostream& out, T number) {
  static_assert(std::is_arithmetic_v<T>);
  writeBytes(out, &number, sizeof number);
}

/// An array of NumPy, format 1.0. `channels` 1: two-dimensional.
void writeNumpy(const std::string& file, const std::vector<float>& numbers, int width, int height,
                int channels) {
  const std::string last = channels == 1 ? "" : fmt::format(", {}", channels);
  std::string header = fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {}{}), }}",
                                   height, width, last);
  constexpr std::size_t kBefore = 10, kAlign = 64;
  header.append(kAlign - (kBefore + header.size() + 1) % kAlign, ' ');
  header += '\n';
  io::OutputFile out(file);
  out.stream() << "\x93NUMPY";
  writeNumber<std::uint16_t>(out.stream(), 1);
  writeNumber(out.stream(), static_cast<std::uint16_t>(header.size()));
  out.stream() << header;
  writeBytes(out.stream(), numbers.data(), sizeof(float) * numbers.size());
  out.finish();
}

/// An attribute in the header of an OpenEXR file: name, type, size, then the value.
template <class... T> void writeAttribute(std::ostream& out, const char* name, const char* type, T... value) {
  writeBytes(out, name, std::strlen(name) + 1), writeBytes(out, type, std::strlen(type) + 1);
  writeNumber(out, static_cast<std::int32_t>((sizeof value + ... + 0)));
  (writeNumber(out, value), ...);
}

/// OpenEXR with one part of scan lines of floats, without compression. `names`: of the channels, ascending.
void writeExr(const std::string& file, const std::vector<float>& numbers, int width, int height,
              const std::vector<std::string>& names) {
  constexpr std::int32_t kMagic = 20000630, kVersion = 2, kFloat = 2;
  std::ostringstream header;
  writeNumber(header, kMagic), writeNumber(header, kVersion);
  std::string channels;
  for (const std::string& name : names) {
    // name, type, two words without meaning for floats, one sample per pixel along x and y
    channels += name + '\0';
    for (const std::int32_t word : {kFloat, std::int32_t{0}, std::int32_t{1}, std::int32_t{1}})
      channels.append(reinterpret_cast<const char*>(&word), sizeof word);
  }
  channels += '\0';
  writeBytes(header, "channels\0chlist", sizeof "channels\0chlist");
  writeNumber(header, static_cast<std::int32_t>(channels.size()));
  writeBytes(header, channels.data(), channels.size());
  const std::int32_t lastX = width - 1, lastY = height - 1, zero = 0;
  constexpr std::uint8_t kNone = 0, kDownward = 0;
  writeAttribute(header, "compression", "compression", kNone);
  writeAttribute(header, "dataWindow", "box2i", zero, zero, lastX, lastY);
  writeAttribute(header, "displayWindow", "box2i", zero, zero, lastX, lastY);
  writeAttribute(header, "lineOrder", "lineOrder", kDownward);
  writeAttribute(header, "pixelAspectRatio", "float", 1.f);
  writeAttribute(header, "screenWindowCenter", "v2f", 0.f, 0.f);
  writeAttribute(header, "screenWindowWidth", "float", 1.f);
  writeNumber(header, std::uint8_t{0});  // the end of the header
  const std::size_t line = static_cast<std::size_t>(width) * names.size(), lineBytes = sizeof(float) * line;
  const std::string before = header.str();
  const std::uint64_t first = before.size() + sizeof(std::uint64_t) * static_cast<std::size_t>(height);
  io::OutputFile output(file);
  std::ostream& out = output.stream();
  out << before;
  constexpr std::size_t kBeforeLine = 2 * sizeof(std::int32_t);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y)
    writeNumber(out, std::uint64_t{first + y * (kBeforeLine + lineBytes)});
  std::vector<float> ordered(line);  // channel after channel
  for (std::int32_t y = 0; y < height; ++y) {
    const float* const from = numbers.data() + static_cast<std::size_t>(y) * line;
    for (std::size_t c = 0; c < names.size(); ++c)
      for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x)
        ordered[c * static_cast<std::size_t>(width) + x] = from[x * names.size() + c];
    writeNumber(out, y), writeNumber(out, static_cast<std::int32_t>(lineBytes));
    writeBytes(out, ordered.data(), lineBytes);
  }
  output.finish();
}

std::string endOf(const std::string& file) { return std::filesystem::path(file).extension().string(); }

/// Millimeters up to 65.534 m; 65535: what is farther, and the sky.
std::vector<std::uint16_t> depthNumbers(const std::vector<float>& depths) {
  std::vector<std::uint16_t> numbers;
  for (const float depth : depths)
    numbers.push_back(depth < 65.5345f ? static_cast<std::uint16_t>(std::lround(1000 * depth)) : 65535);
  return numbers;
}
/// -1 to 1 as 0 to 65534; 0, 0, 0 in the sky.
std::vector<std::uint16_t> normalNumbers(const std::vector<float>& normals) {
  std::vector<std::uint16_t> numbers;
  for (std::size_t i = 0; i < normals.size(); i += 3) {
    const bool sky = normals[i] == 0 && normals[i + 1] == 0 && normals[i + 2] == 0;
    for (std::size_t k = i; k < i + 3; ++k)
      numbers.push_back(static_cast<std::uint16_t>(
          sky ? 0 : std::lround(32767 + 32767 * std::clamp(normals[k], -1.f, 1.f))));
  }
  return numbers;
}

}  // namespace

void checkLayerFile(const std::string& option, const std::string& file) {
  if (file.empty()) return;
  if (const std::string end = endOf(file); end != ".npy" && end != ".exr" && end != ".png")
    throw Error(option, "a file that ends in .npy, .exr or .png", file);
  requireWritable(file);
}

void writeDepths(const std::string& file, const std::vector<float>& depths, int width, int height) {
  if (endOf(file) == ".png") return io::writePng16(width, height, 1, depthNumbers(depths), file);
  if (endOf(file) == ".exr") return writeExr(file, depths, width, height, {"Z"});
  writeNumpy(file, depths, width, height, 1);
}

void writeNormals(const std::string& file, const std::vector<float>& normals, int width, int height) {
  if (endOf(file) == ".png") return io::writePng16(width, height, 3, normalNumbers(normals), file);
  if (endOf(file) == ".exr") return writeExr(file, normals, width, height, {"N.X", "N.Y", "N.Z"});
  writeNumpy(file, normals, width, height, 3);
}

}  // namespace rubble::cli

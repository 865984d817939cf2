#include <cstdint>
#include <vector>

#if defined(RUBBLE_HAS_PNG)
#include <png.h>
#endif

#include <rubble/error.h>

#include "io/output_file.h"
#include "io/picture.h"

namespace rubble::io {

#if defined(RUBBLE_HAS_PNG)
static void write(png_image& header, const void* rows, int stride, const std::string& file) {
  OutputFile out(file);
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::vector<char> bytes(size);
  const int made = png_image_write_to_memory(&header, bytes.data(), &size, 0, rows, stride, nullptr);
  const std::string message = header.message;
  png_image_free(&header);
  if (!made) throw Error(file, "a picture that can be compressed", message);
  out.stream().write(bytes.data(), static_cast<std::streamsize>(size));
  out.finish();
}
static png_image headerOf(int width, int height, png_uint_32 format) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(width);
  header.height = static_cast<png_uint_32>(height);
  header.format = format;
  return header;
}

void writePng(const Image& image, const std::string& file) {
  const bool hasAlpha = !image.alpha.empty();
  png_image header = headerOf(image.width, image.height, hasAlpha ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB);
  std::vector<std::uint8_t> withAlpha;
  for (std::size_t i = 0; i < image.alpha.size(); ++i) {
    withAlpha.insert(withAlpha.end(), &image.rgb[3 * i], &image.rgb[3 * i] + 3);
    withAlpha.push_back(image.alpha[i]);
  }
  write(header, hasAlpha ? withAlpha.data() : image.rgb.data(), (hasAlpha ? 4 : 3) * image.width, file);
}

void writePng16(int width, int height, int channels, const std::vector<std::uint16_t>& numbers,
                const std::string& file) {
  png_image header = headerOf(width, height, channels == 1 ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_LINEAR_RGB);
  write(header, numbers.data(), channels * width, file);
}

Image readPng(const std::string& file) {
  constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 26;
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  std::vector<std::uint8_t> pixels;
  bool isRead = png_image_begin_read_from_file(&header, file.c_str()) != 0;
  if (isRead && std::uint64_t{header.width} * header.height > kMostPixels) {
    png_image_free(&header);
    throw Error(file, "a picture of at most 2^26 pixels", "a larger one");
  }
  if (isRead) {
    header.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
    header.format = PNG_FORMAT_RGBA;
    pixels.resize(PNG_IMAGE_SIZE(header));
    isRead = png_image_finish_read(&header, nullptr, pixels.data(), 0, nullptr) != 0;
  }
  if (!isRead) throw Error(file, "a PNG picture", header.message);
  Image out;
  out.width = static_cast<int>(header.width), out.height = static_cast<int>(header.height);
  for (std::size_t i = 0; i < pixels.size(); i += 4) {
    out.rgb.insert(out.rgb.end(), &pixels[i], &pixels[i] + 3);
    out.alpha.push_back(pixels[i + 3]);
  }
  return out;
}
#else
Image readPng(const std::string& file) {
  throw Error(file, "a build with libpng to read pictures (Debian: apt-get install libpng-dev)",
              "one without");
}
void writePng(const Image&, const std::string& file) {
  throw Error(file, "a build with libpng to write pictures (Debian: apt-get install libpng-dev)",
              "one without");
}
void writePng16(int, int, int, const std::vector<std::uint16_t>&, const std::string& file) {
  writePng({}, file);
}
#endif

}  // namespace rubble::io

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#if defined(RUBBLE_HAS_PNG)
#include <png.h>
#endif

#include <rubble/error.h>

#include "io/picture.h"

namespace rubble::io {

#if defined(RUBBLE_HAS_PNG)
void writePng(const Image& image, const std::string& file) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(std::fopen(file.c_str(), "wb"), std::fclose);
  if (!out) throw Error(file, "a file that can be written", std::strerror(errno));
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  const int written = png_image_write_to_stdio(&header, out.get(), 0, image.rgb.data(), 3 * image.width, nullptr);
  const std::string message = header.message;
  png_image_free(&header);
  if (!written || std::fflush(out.get()) != 0) throw Error(file, "to be written in full", message.empty() ? std::strerror(errno) : message);
}
#else
void writePng(const Image&, const std::string& file) { throw Error(file, "a build with libpng to write pictures", "one without"); }
#endif

}  // namespace rubble::io

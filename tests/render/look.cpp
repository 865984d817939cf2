#include "tests/render/look.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include <png.h>

namespace rubble::render {

HeadlessContext& softwareContext() {
  setenv("RUBBLE_GL", "software", 1);
  static HeadlessContext context;
  return context;
}

io::PictureBody bodyOf(const Shape& shape, const Vec3& position) {
  io::PictureBody body;
  body.shape = shape;
  body.position = position;
  if (shape.type == ShapeType::Plane) body.motion = Motion::Static;
  return body;
}

int channel(const io::Image& image, int x, int y, int which) {
  return image.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                        static_cast<std::size_t>(x)) +
                   static_cast<std::size_t>(which)];
}

double brightness(const io::Image& image, int x, int y) {
  return .30 * channel(image, x, y, 0) + .59 * channel(image, x, y, 1) + .11 * channel(image, x, y, 2);
}

io::Image readPng(const std::string& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, file.c_str()))
    throw std::runtime_error(file + ": " + png.message);
  png.format = PNG_FORMAT_RGB;
  io::Image image{static_cast<int>(png.width), static_cast<int>(png.height),
                  std::vector<std::uint8_t>(PNG_IMAGE_SIZE(png))};
  if (!png_image_finish_read(&png, nullptr, image.rgb.data(), 0, nullptr))
    throw std::runtime_error(file + ": " + png.message);
  return image;
}

namespace {

double blurred(const io::Image& image, int x, int y, int which) {
  double sum = 0;
  int count = 0;
  for (int dy = -2; dy <= 2; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) {
      if (x + dx < 0 || y + dy < 0 || x + dx >= image.width || y + dy >= image.height) continue;
      sum += channel(image, x + dx, y + dy, which);
      ++count;
    }
  }
  return sum / count;
}

double windowSimilarity(const io::Image& a, const io::Image& b, int x0, int y0) {
  constexpr int kWindow = 8;
  constexpr double kC1 = .01 * 255 * .01 * 255, kC2 = .03 * 255 * .03 * 255;
  double ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
  for (int y = y0; y < y0 + kWindow; ++y) {
    for (int x = x0; x < x0 + kWindow; ++x) {
      const double pa = brightness(a, x, y), pb = brightness(b, x, y);
      ma += pa, mb += pb, aa += pa * pa, bb += pb * pb, ab += pa * pb;
    }
  }
  constexpr double n = kWindow * kWindow;
  ma /= n, mb /= n;
  const double va = aa / n - ma * ma, vb = bb / n - mb * mb, cov = ab / n - ma * mb;
  return (2 * ma * mb + kC1) * (2 * cov + kC2) / ((ma * ma + mb * mb + kC1) * (va + vb + kC2));
}

}  // namespace

Likeness likeness(const io::Image& a, const io::Image& b) {
  if (a.width != b.width || a.height != b.height) throw std::runtime_error("pictures of two sizes");
  Likeness result{0, 0};
  int windows = 0;
  for (int y = 0; y + 8 <= a.height; y += 4) {
    for (int x = 0; x + 8 <= a.width; x += 4) {
      result.structure += windowSimilarity(a, b, x, y);
      ++windows;
    }
  }
  result.structure /= windows;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      for (int c = 0; c < 3; ++c)
        result.largest = std::max(result.largest, std::fabs(blurred(a, x, y, c) - blurred(b, x, y, c)));
  return result;
}

}  // namespace rubble::render

#include "render/canvas.h"

#if defined(RUBBLE_HAS_CAIRO)
#include <cmath>
#include <numbers>

#include <cairo.h>

namespace rubble::render {

struct ImageCanvas::Impl {
  io::Image& image;
  cairo_surface_t* surface;
  cairo_t* cairo;

  explicit Impl(io::Image& image_)
      : image(image_), surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, image_.width, image_.height)), cairo(cairo_create(surface)) {
    forEachPixel([](std::uint32_t& pixel, std::uint8_t* rgb) { pixel = static_cast<std::uint32_t>(rgb[0] << 16 | rgb[1] << 8 | rgb[2]); });
    cairo_surface_mark_dirty(surface);
  }
  ~Impl() {
    cairo_surface_flush(surface);
    forEachPixel([](std::uint32_t& pixel, std::uint8_t* rgb) {
      for (int c = 0; c < 3; ++c) rgb[c] = static_cast<std::uint8_t>(pixel >> (16 - 8 * c));
    });
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  template <class Visit> void forEachPixel(const Visit& visit) {
    unsigned char* data = cairo_image_surface_get_data(surface);
    const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface));
    const auto width = static_cast<std::size_t>(image.width);
    for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
      auto* row = reinterpret_cast<std::uint32_t*>(data + y * stride);
      for (std::size_t x = 0; x < width; ++x) visit(row[x], &image.rgb[3 * (y * width + x)]);
    }
  }
  void setInk(const Ink& ink) const {
    const auto channel = [&](int shift) { return static_cast<double>((ink.rgb >> shift) & 255u) / 255; };
    cairo_set_source_rgba(cairo, channel(16), channel(8), channel(0), ink.opacity);
  }
  void setFont(const TextStyle& style) const {
    cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, style.size);
  }
};

ImageCanvas::ImageCanvas(io::Image& image, double scale) : impl_(std::make_unique<Impl>(image)) { cairo_scale(impl_->cairo, scale, scale); }
ImageCanvas::~ImageCanvas() = default;

void ImageCanvas::rectangle(const Point& corner, double width, double height, const Ink& fill, double radius) {
  constexpr double kQuarter = std::numbers::pi / 2;
  impl_->setInk(fill);
  if (radius <= 0) {
    cairo_rectangle(impl_->cairo, corner.x, corner.y, width, height);
  } else {
    cairo_new_sub_path(impl_->cairo);
    for (int i = 0; i < 4; ++i) {
      const double x = corner.x + (i == 0 || i == 3 ? width - radius : radius), y = corner.y + (i < 2 ? height - radius : radius);
      cairo_arc(impl_->cairo, x, y, radius, i * kQuarter, (i + 1) * kQuarter);
    }
    cairo_close_path(impl_->cairo);
  }
  cairo_fill(impl_->cairo);
}

void ImageCanvas::line(const std::vector<Point>& points, double width, const Ink& ink, const std::vector<double>& dashes) {
  impl_->setInk(ink);
  cairo_new_path(impl_->cairo);
  for (const Point& p : points) cairo_line_to(impl_->cairo, p.x, p.y);
  cairo_set_line_width(impl_->cairo, width);
  cairo_set_line_join(impl_->cairo, CAIRO_LINE_JOIN_ROUND);
  cairo_set_dash(impl_->cairo, dashes.data(), static_cast<int>(dashes.size()), 0);
  cairo_stroke(impl_->cairo);
}

void ImageCanvas::disc(const Point& middle, double radius, const Ink& fill) {
  impl_->setInk(fill);
  cairo_new_path(impl_->cairo);
  cairo_arc(impl_->cairo, middle.x, middle.y, radius, 0, 2 * std::numbers::pi);
  cairo_fill(impl_->cairo);
}

void ImageCanvas::text(const Point& at, const std::string& text, const TextStyle& style) {
  impl_->setInk(style.ink);
  impl_->setFont(style);
  const double shift = style.align == Align::Start ? 0 : textWidth(text, style) * (style.align == Align::Middle ? .5 : 1);
  cairo_save(impl_->cairo);
  cairo_translate(impl_->cairo, at.x, at.y);
  cairo_rotate(impl_->cairo, -style.turn * std::numbers::pi / 180);
  cairo_move_to(impl_->cairo, -shift, 0);
  cairo_show_text(impl_->cairo, text.c_str());
  cairo_restore(impl_->cairo);
}

double ImageCanvas::textWidth(const std::string& text, const TextStyle& style) const {
  impl_->setFont(style);
  cairo_text_extents_t extents;
  cairo_text_extents(impl_->cairo, text.c_str(), &extents);
  return extents.x_advance;
}

}  // namespace rubble::render
#endif

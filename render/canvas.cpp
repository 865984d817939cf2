#include "render/canvas.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <cairo-svg.h>
#include <cairo.h>

#include <rubble/error.h>

namespace rubble::render {
namespace {

cairo_status_t append(void* document, const unsigned char* bytes, unsigned count) {
  static_cast<std::string*>(document)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

cairo_surface_t* svgSurface(std::string& document, double width, double height) {
  cairo_surface_t* const surface = cairo_svg_surface_create_for_stream(append, &document, width, height);
  cairo_svg_surface_set_document_unit(surface, CAIRO_SVG_UNIT_PX);
  return surface;
}

template <class Visit> void forEachPixel(cairo_surface_t* surface, io::Image& image, const Visit& visit) {
  unsigned char* const data = cairo_image_surface_get_data(surface);
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface));
  const auto width = static_cast<std::size_t>(image.width);
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    auto* row = reinterpret_cast<std::uint32_t*>(data + y * stride);
    for (std::size_t x = 0; x < width; ++x) visit(row[x], &image.rgb[3 * (y * width + x)]);
  }
}

cairo_surface_t* imageSurface(io::Image& image) {
  cairo_surface_t* const surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.width, image.height);
  forEachPixel(surface, image, [](std::uint32_t& pixel, const std::uint8_t* rgb) {
    pixel = static_cast<std::uint32_t>(rgb[0] << 16 | rgb[1] << 8 | rgb[2]);
  });
  cairo_surface_mark_dirty(surface);
  return surface;
}

}  // namespace

struct Canvas::Impl {
  cairo_surface_t* surface;
  cairo_t* cairo;
  io::Image* image;

  Impl(cairo_surface_t* surface_, io::Image* image_)
      : surface(surface_), cairo(cairo_create(surface_)), image(image_) {}
  ~Impl() {
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void setInk(const Ink& ink) const {
    const auto channel = [&](int shift) { return static_cast<double>((ink.rgb >> shift) & 255u) / 255; };
    cairo_set_source_rgba(cairo, channel(16), channel(8), channel(0), ink.opacity);
  }
  void setFont(const TextStyle& style) const {
    const cairo_font_weight_t weight = style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL;
    cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, weight);
    cairo_set_font_size(cairo, style.size);
  }
  /// Text that Cairo takes, in the font that is set. A text that is not UTF-8 would stop all further drawing.
  std::string drawable(std::string text) const {
    for (char& c : text)
      if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
    cairo_glyph_t* glyphs = nullptr;
    int count = 0;
    const cairo_status_t status = cairo_scaled_font_text_to_glyphs(
        cairo_get_scaled_font(cairo), 0, 0, text.data(), static_cast<int>(text.size()), &glyphs, &count,
        nullptr, nullptr, nullptr);
    cairo_glyph_free(glyphs);
    if (status == CAIRO_STATUS_INVALID_STRING)
      std::replace_if(
          text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) > '\x7e'; }, '?');
    return text;
  }
};

Canvas::Canvas(io::Image& image, double scale) : impl_(std::make_unique<Impl>(imageSurface(image), &image)) {
  cairo_scale(impl_->cairo, scale, scale);
}
Canvas::Canvas(std::string& document, double width, double height)
    : impl_(std::make_unique<Impl>(svgSurface(document, width, height), nullptr)) {}
Canvas::~Canvas() = default;

void Canvas::finish() {
  cairo_surface_flush(impl_->surface);
  if (impl_->image) {
    forEachPixel(impl_->surface, *impl_->image, [](std::uint32_t pixel, std::uint8_t* rgb) {
      for (int c = 0; c < 3; ++c) rgb[c] = static_cast<std::uint8_t>(pixel >> (16 - 8 * c));
    });
  }
  cairo_surface_finish(impl_->surface);
  const cairo_status_t drawn = cairo_status(impl_->cairo), stored = cairo_surface_status(impl_->surface);
  const cairo_status_t status = drawn != CAIRO_STATUS_SUCCESS ? drawn : stored;
  if (status != CAIRO_STATUS_SUCCESS)
    throw Error("Cairo", "to draw everything", cairo_status_to_string(status));
}

void Canvas::rectangle(const Point& corner, double width, double height, const Ink& fill, double radius) {
  constexpr double kQuarter = std::numbers::pi / 2;
  impl_->setInk(fill);
  if (radius <= 0) {
    cairo_rectangle(impl_->cairo, corner.x, corner.y, width, height);
  } else {
    cairo_new_sub_path(impl_->cairo);
    for (int i = 0; i < 4; ++i) {
      const double x = corner.x + (i == 0 || i == 3 ? width - radius : radius);
      const double y = corner.y + (i < 2 ? height - radius : radius);
      cairo_arc(impl_->cairo, x, y, radius, i * kQuarter, (i + 1) * kQuarter);
    }
    cairo_close_path(impl_->cairo);
  }
  cairo_fill(impl_->cairo);
}

void Canvas::line(const std::vector<Point>& points, double width, const Ink& ink) {
  impl_->setInk(ink);
  cairo_new_path(impl_->cairo);
  for (const Point& p : points) cairo_line_to(impl_->cairo, p.x, p.y);
  cairo_set_line_width(impl_->cairo, width);
  cairo_set_line_join(impl_->cairo, CAIRO_LINE_JOIN_ROUND);
  cairo_stroke(impl_->cairo);
}

void Canvas::disc(const Point& middle, double radius, const Ink& fill) {
  impl_->setInk(fill);
  cairo_new_path(impl_->cairo);
  cairo_arc(impl_->cairo, middle.x, middle.y, radius, 0, 2 * std::numbers::pi);
  cairo_fill(impl_->cairo);
}

void Canvas::text(const Point& at, const std::string& text, const TextStyle& style) {
  impl_->setInk(style.ink);
  const double shift = style.align == Align::Start
                           ? 0
                           : textWidth(text, style) * (style.align == Align::Middle ? .5 : 1);
  impl_->setFont(style);
  cairo_save(impl_->cairo);
  cairo_translate(impl_->cairo, at.x, at.y);
  cairo_rotate(impl_->cairo, -style.turn * std::numbers::pi / 180);
  cairo_move_to(impl_->cairo, -shift, 0);
  cairo_show_text(impl_->cairo, impl_->drawable(text).c_str());
  cairo_restore(impl_->cairo);
}

double Canvas::textWidth(const std::string& text, const TextStyle& style) const {
  impl_->setFont(style);
  cairo_text_extents_t extents;
  cairo_text_extents(impl_->cairo, impl_->drawable(text).c_str(), &extents);
  return extents.x_advance;
}

}  // namespace rubble::render

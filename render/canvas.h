#pragma once
/// Lines, rectangles and text for plots and captions, onto an SVG file or onto pixels.
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "io/picture.h"

namespace rubble::render {

struct Point {
  double x = 0, y = 0;  ///< from the left and from the top
};

/// Colour as 0xrrggbb (sRGB) and opacity 0 to 1.
struct Ink {
  std::uint32_t rgb = 0;
  double opacity = 1;
};

enum class Align { Start, Middle, End };

struct TextStyle {
  double size = 12;  ///< height of the type
  Ink ink;
  bool bold = false;
  Align align = Align::Start;
  double turn = 0;  ///< anticlockwise [degrees]
};

/// Something to draw on. Units are pixels at scale 1; y points down; text stands on its baseline.
class Canvas {
 public:
  virtual ~Canvas() = default;
  virtual void rectangle(const Point& corner, double width, double height, const Ink& fill, double radius = 0) = 0;
  virtual void line(const std::vector<Point>& points, double width, const Ink& ink, const std::vector<double>& dashes = {}) = 0;
  virtual void disc(const Point& middle, double radius, const Ink& fill) = 0;
  virtual void text(const Point& at, const std::string& text, const TextStyle& style) = 0;
  /// Width of a text; an estimate where no font is at hand.
  virtual double textWidth(const std::string& text, const TextStyle& style) const = 0;
};

/// Collects an SVG document.
class SvgCanvas final : public Canvas {
 public:
  SvgCanvas(double width, double height);
  void rectangle(const Point& corner, double width, double height, const Ink& fill, double radius = 0) override;
  void line(const std::vector<Point>& points, double width, const Ink& ink, const std::vector<double>& dashes = {}) override;
  void disc(const Point& middle, double radius, const Ink& fill) override;
  void text(const Point& at, const std::string& text, const TextStyle& style) override;
  double textWidth(const std::string& text, const TextStyle& style) const override;
  /// The document.
  std::string document() const;

 private:
  std::string body_, head_;
};

/// Can this build draw text and plots onto pixels: "on" or "off: built without Cairo".
std::string cairoStatus();

#if defined(RUBBLE_HAS_CAIRO)
/// Draws over an image.
class ImageCanvas final : public Canvas {
 public:
  /// `scale` pixels to a unit. The image is changed when the canvas is destroyed.
  explicit ImageCanvas(io::Image& image, double scale = 1);
  ~ImageCanvas() override;
  void rectangle(const Point& corner, double width, double height, const Ink& fill, double radius = 0) override;
  void line(const std::vector<Point>& points, double width, const Ink& ink, const std::vector<double>& dashes = {}) override;
  void disc(const Point& middle, double radius, const Ink& fill) override;
  void text(const Point& at, const std::string& text, const TextStyle& style) override;
  double textWidth(const std::string& text, const TextStyle& style) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
#endif

}  // namespace rubble::render

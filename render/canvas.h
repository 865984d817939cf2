#pragma once
/// Lines, rectangles and text for plots and captions, by Cairo: onto an SVG file or onto pixels.
#include <memory>
#include <string>
#include <vector>

#include "io/picture.h"

namespace rubble::render {

struct Point {
  double x = 0, y = 0;  ///< from the left and from the top
};

/// Color as 0xrrggbb (sRGB) and opacity 0 to 1.
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
  /// Draws over an image, which is changed by finish(); `scale` pixels to a unit.
  explicit Canvas(io::Image& image, double scale = 1);
  /// Appends an SVG document of this size to `document`, which is complete after finish().
  Canvas(std::string& document, double width, double height);
  ~Canvas();

  void rectangle(const Point& corner, double width, double height, const Ink& fill, double radius = 0);
  void line(const std::vector<Point>& points, double width, const Ink& ink);
  void disc(const Point& middle, double radius, const Ink& fill);
  /// UTF-8. Question marks replace control characters, and everything beyond ASCII if the text is not UTF-8.
  void text(const Point& at, const std::string& text, const TextStyle& style);
  double textWidth(const std::string& text, const TextStyle& style) const;
  /// Ends the drawing. Throws Error if some of it failed.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rubble::render

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string_view>

#include "render/canvas.h"

namespace rubble::render {
namespace {

/// Mean width of a letter over the size of the type.
constexpr double kLetterWidth = .55;
constexpr const char* kFonts = "DejaVu Sans, Helvetica, Arial, sans-serif";

/// Two digits are enough, and -0 is 0.
std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", std::round(value * 100) / 100 + 0.);
  std::string s = text;
  while (s.back() == '0') s.pop_back();
  if (s.back() == '.') s.pop_back();
  return s == "-0" ? "0" : s;
}

std::string inkText(const char* what, const Ink& ink) {
  char text[64];
  std::snprintf(text, sizeof text, " %s=\"#%06x\"", what, ink.rgb);
  std::string s = text;
  if (ink.opacity < 1) s += std::string(" ") + what + "-opacity=\"" + number(ink.opacity) + "\"";
  return s;
}

/// Bytes of the UTF-8 character that a text begins with; 0 if it is none that XML may hold.
std::size_t characterSize(std::string_view text) {
  const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
  const unsigned first = byte(0);
  if (first < 0x80) return first >= 0x20 || first == '\t' || first == '\n' || first == '\r' ? 1 : 0;
  const std::size_t size = first >= 0xc2 && first < 0xe0 ? 2 : first >= 0xe0 && first < 0xf0 ? 3 : first >= 0xf0 && first < 0xf5 ? 4 : 0;
  if (size == 0) return 0;
  std::uint32_t code = first & (0x7fu >> size);
  for (std::size_t k = 1; k < size; ++k) {
    if ((byte(k) & 0xc0) != 0x80) return 0;
    code = code << 6 | (byte(k) & 0x3f);
  }
  // longer than it need be, half of a pair, no character, beyond the last one
  const bool wrong = (size == 3 && code < 0x800) || (size == 4 && code < 0x10000) || (code >= 0xd800 && code < 0xe000) || code == 0xfffe ||
                     code == 0xffff || code > 0x10ffff;
  return wrong ? 0 : size;
}

/// As XML has it; what no XML may hold (control characters, broken UTF-8) becomes the replacement character.
std::string escaped(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    const std::size_t size = characterSize(std::string_view(text).substr(at));
    const std::string_view whole = std::string_view(text).substr(at, size);
    at += std::max<std::size_t>(size, 1);
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += size > 0 ? whole : std::string_view("\xef\xbf\xbd");
  }
  return out;
}

std::string attribute(const char* name, double value) { return std::string(" ") + name + "=\"" + number(value) + "\""; }

}  // namespace

std::string cairoStatus() {
#if defined(RUBBLE_HAS_CAIRO)
  return "on";
#else
  return "off: built without Cairo";
#endif
}

SvgCanvas::SvgCanvas(double width, double height) {
  head_ = "<svg xmlns=\"http://www.w3.org/2000/svg\"" + attribute("width", width) + attribute("height", height) + " viewBox=\"0 0 " +
          number(width) + " " + number(height) + "\" font-family=\"" + kFonts + "\">\n";
}

void SvgCanvas::rectangle(const Point& corner, double width, double height, const Ink& fill, double radius) {
  body_ += "<rect" + attribute("x", corner.x) + attribute("y", corner.y) + attribute("width", width) + attribute("height", height) +
           (radius > 0 ? attribute("rx", radius) : "") + inkText("fill", fill) + "/>\n";
}

void SvgCanvas::line(const std::vector<Point>& points, double width, const Ink& ink, const std::vector<double>& dashes) {
  body_ += "<polyline points=\"";
  for (const Point& p : points) body_ += number(p.x) + "," + number(p.y) + (&p == &points.back() ? "" : " ");
  body_ += "\" fill=\"none\" stroke-linejoin=\"round\"" + attribute("stroke-width", width) + inkText("stroke", ink);
  if (!dashes.empty()) {
    body_ += " stroke-dasharray=\"";
    for (const double& dash : dashes) body_ += number(dash) + (&dash == &dashes.back() ? "\"" : " ");
  }
  body_ += "/>\n";
}

void SvgCanvas::disc(const Point& middle, double radius, const Ink& fill) {
  body_ += "<circle" + attribute("cx", middle.x) + attribute("cy", middle.y) + attribute("r", radius) + inkText("fill", fill) + "/>\n";
}

void SvgCanvas::text(const Point& at, const std::string& text, const TextStyle& style) {
  body_ += "<text" + attribute("x", at.x) + attribute("y", at.y) + attribute("font-size", style.size) + inkText("fill", style.ink);
  if (style.bold) body_ += " font-weight=\"bold\"";
  if (style.align != Align::Start) body_ += std::string(" text-anchor=\"") + (style.align == Align::Middle ? "middle" : "end") + "\"";
  if (style.turn != 0) body_ += " transform=\"rotate(" + number(-style.turn) + " " + number(at.x) + " " + number(at.y) + ")\"";
  body_ += ">" + escaped(text) + "</text>\n";
}

double SvgCanvas::textWidth(const std::string& text, const TextStyle& style) const {
  return kLetterWidth * style.size * static_cast<double>(text.size()) * (style.bold ? 1.08 : 1);
}

std::string SvgCanvas::document() const { return head_ + body_ + "</svg>\n"; }

}  // namespace rubble::render

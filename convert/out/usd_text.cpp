/// USD layers as text (.usda).
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>

#include "convert/out/scratch.h"
#include "convert/out/usd_layer.h"
#include "io/output_file.h"

namespace rubble::convert {
namespace {

/// Samples of an attribute go to a file of their own beyond this many bytes: the text has all samples of an
/// attribute together, and frames come with those of all attributes.
constexpr std::size_t kMostInMemory = 1 << 20;

template <class T>
requires std::is_arithmetic_v<T>
void addText(std::string& out, T value) {
  char text[32];
  out.append(text, std::to_chars(text, text + sizeof text, value).ptr);
}
void addText(std::string& out, bool value) { out += value ? "true" : "false"; }
void addText(std::string& out, const Token& value) { out += '"' + value.text + '"'; }

/// "(1, 2, 3)" of numbers that `at` gives.
template <class At> void addTuple(std::string& out, int count, const At& at) {
  for (int k = 0; k < count; ++k) out += k == 0 ? "(" : ", ", addText(out, at(k));
  out += ')';
}
void addText(std::string& out, const std::array<float, 2>& v) {
  addTuple(out, 2, [&](int k) { return v[static_cast<std::size_t>(k)]; });
}
void addText(std::string& out, const Vec3f& v) {
  addTuple(out, 3, [&](int k) { return v[k]; });
}
void addText(std::string& out, const Quat4f& q) {
  addTuple(out, 4, [&](int k) { return q[static_cast<std::size_t>(k + 3) % 4]; });  // the scalar first
}
float ofHalf(std::uint16_t h) {
  const int exponent = h >> 10 & 31, fraction = h & 1023;
  const float size = exponent == 0 ? std::ldexp(static_cast<float>(fraction), -24)
                                   : std::ldexp(static_cast<float>(1024 + fraction), exponent - 25);
  return h & 0x8000 ? -size : size;
}
void addText(std::string& out, const Quat4h& q) {
  addText(out, Quat4f{ofHalf(q[0]), ofHalf(q[1]), ofHalf(q[2]), ofHalf(q[3])});
}
void addText(std::string& out, const Matrix4& m) {
  for (std::size_t row = 0; row < 4; ++row) {
    out += row == 0 ? "( " : ", ";
    addTuple(out, 4, [&](int k) { return m[4 * row + static_cast<std::size_t>(k)]; });
  }
  out += " )";
}
template <class T> void addText(std::string& out, std::span<const T> values) {
  out += '[';
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) out += ", ";
    addText(out, values[i]);
  }
  out += ']';
}
void addText(std::string& out, const UsdValue& value) {
  std::visit([&](const auto& v) { addText(out, v); }, value);
}

class TextLayer final : public UsdLayer {
 public:
  explicit TextLayer(const std::string& file) : file_(file), out_(file) {}

  void set(int attribute, const UsdValue& value) override {
    std::string& text = defaults_[attribute];
    text.clear();
    addText(text, value);
  }

  void sample(int attribute, double time, const UsdValue& value) override {
    Samples& samples = samples_[attribute];
    addText(samples.text += "        ", time);
    addText(samples.text += ": ", value);
    samples.text += ",\n";
    if (samples.text.size() < kMostInMemory) return;
    if (!samples.rest) samples.rest = std::make_unique<Rest>(file_);
    samples.rest->out << samples.text;
    samples.text.clear();
  }

  void finish(const UsdHead& head) override {
    std::string text = "#usda 1.0\n(\n    defaultPrim = \"" + head.defaultPrim + "\"\n    doc = \"";
    for (const char c : head.comment) text += c == '"' || c == '\\' || c == '\n' ? ' ' : c;
    addText(text += "\"\n    endTimeCode = ", head.last);
    addText(text += "\n    framesPerSecond = ", head.rate);
    addText(text += "\n    metersPerUnit = 1\n    startTimeCode = ", head.first);
    addText(text += "\n    timeCodesPerSecond = ", head.rate);
    out_.stream() << text << "\n    upAxis = \"" << (head.yUp ? 'Y' : 'Z') << "\"\n)\n";
    for (const int prim : top_) writePrim(prim, "");
    out_.finish();
  }

 private:
  /// Samples that are on the disk until the layer is finished.
  struct Rest {
    ScratchFile name;
    std::ofstream out;
    explicit Rest(const std::string& file) : name(file), out(name.path(), std::ios::binary) {}
  };
  struct Samples {
    std::unique_ptr<Rest> rest;
    std::string text;
  };

  void writePrim(int number, const std::string& indent) {
    const Prim& prim = prims_[static_cast<std::size_t>(number)];
    std::ostream& out = out_.stream();
    out << '\n' << indent << "def " << prim.type << " \"" << prim.name << "\"\n" << indent << "{\n";
    const std::string inner = indent + "    ";
    for (const int attribute : prim.attributes) writeAttribute(attribute, inner);
    for (const Relation& relation : prim.relations) {
      out << inner << "rel " << relation.name << " = [";
      for (std::size_t i = 0; i < relation.targets.size(); ++i)
        out << (i > 0 ? ", " : "") << '<' << pathOf(relation.targets[i]) << '>';
      out << "]\n";
    }
    for (const int child : prim.children) writePrim(child, inner);
    out << indent << "}\n";
  }

  void writeAttribute(int number, const std::string& indent) {
    const Attribute& a = attributes_[static_cast<std::size_t>(number)];
    std::ostream& out = out_.stream();
    const std::string declared = indent + (a.uniform ? "uniform " : "") + a.type + " " + a.name;
    if (const auto value = defaults_.find(number); value != defaults_.end()) {
      out << declared << " = " << value->second;
      if (!a.interpolation.empty())
        out << " (\n" << indent << "    interpolation = \"" << a.interpolation << "\"\n" << indent << ")";
      out << '\n';
    }
    const auto found = samples_.find(number);
    if (found == samples_.end()) return;
    if (!defaults_.contains(number) && !a.interpolation.empty())
      out << declared << " (\n"
          << indent << "    interpolation = \"" << a.interpolation << "\"\n"
          << indent << ")\n";
    out << declared << ".timeSamples = {\n";
    if (Rest* const rest = found->second.rest.get()) {
      rest->out.close();
      std::ifstream in(rest->name.path(), std::ios::binary);
      if (!rest->out || !in || !(out << in.rdbuf())) out.setstate(std::ios::failbit);
    }
    out << found->second.text << indent << "}\n";
  }

  std::string file_;
  std::map<int, std::string> defaults_;
  std::map<int, Samples> samples_;
  io::OutputFile out_;
};

}  // namespace

std::unique_ptr<UsdLayer> textLayer(const std::string& file) { return std::make_unique<TextLayer>(file); }

}  // namespace rubble::convert

/// PLY: a header that names elements and their properties, then text or binary numbers.
#include <algorithm>

#include "io/mesh_readers.h"

namespace rubble::io {

namespace {

enum class Encoding { Text, Little, Big };

struct Property {
  std::string name;
  int type = 0;        ///< place in kTypeNames
  int countType = -1;  ///< of a list, else -1
};
struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

constexpr std::string_view kTypeNames[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                              {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                              {"float", "float32"}, {"double", "float64"}};

int typeNamed(const MeshBytes& in, std::string_view name) {
  for (int k = 0; k < 8; ++k)
    if (name == kTypeNames[k][0] || name == kTypeNames[k][1]) return k;
  in.fail("a type of numbers (\"float\", \"uchar\" ...)", "\"" + std::string(name) + "\"");
}

class PlyReader {
 public:
  explicit PlyReader(MeshBytes& in) : in_(in) {}

  MeshFile read() {
    header();
    for (const Element& element : elements_) {
      if (element.name == "vertex")
        vertices(element);
      else
        rows(element, element.name == "face");
    }
    return std::move(out_);
  }

 private:
  std::string_view need(Words& words, const char* what) {
    const auto word = words.next();
    if (!word) in_.fail(what, "the end of the line");
    return *word;
  }

  void header() {
    if (in_.line() != "ply") in_.fail("\"ply\"", "something else");
    bool hasFormat = false;
    for (;;) {
      Words words(in_.line());
      const auto key = words.next();
      if (!key || *key == "comment" || *key == "obj_info") continue;
      if (*key == "end_header") break;
      if (*key == "format") {
        const std::string_view name = need(words, "a format");
        encoding_ = name == "ascii"                  ? Encoding::Text
                    : name == "binary_little_endian" ? Encoding::Little
                                                     : Encoding::Big;
        if (encoding_ == Encoding::Big && name != "binary_big_endian")
          in_.fail("\"ascii\", \"binary_little_endian\" or \"binary_big_endian\"",
                   "\"" + std::string(name) + "\"");
        hasFormat = true;
      } else if (*key == "element") {
        Element& element = elements_.emplace_back();
        element.name = need(words, "the name of an element");
        element.count = in_.count(in_.toWhole(need(words, "how many there are"), "how many there are"), 1,
                                  "a number of elements");
      } else if (*key == "property") {
        if (elements_.empty()) in_.fail("an element before its properties", "a property");
        Property property;
        const std::string_view type = need(words, "a type");
        if (type == "list")
          property.countType = typeNamed(in_, need(words, "a type")),
          property.type = typeNamed(in_, need(words, "a type"));
        else
          property.type = typeNamed(in_, type);
        property.name = need(words, "the name of a property");
        elements_.back().properties.push_back(property);
      } else {
        in_.fail("\"element\", \"property\" or \"end_header\"", "\"" + std::string(*key) + "\"");
      }
    }
    if (!hasFormat) in_.fail("a line \"format\" in the header", "none");
  }

  double value(int type) {
    if (encoding_ == Encoding::Text) return in_.number("a number");
    const bool swap = (encoding_ == Encoding::Big) != (std::endian::native == std::endian::big);
    switch (type) {
      case 0:
        return in_.binary<std::int8_t>(swap, "a number");
      case 1:
        return in_.binary<std::uint8_t>(swap, "a number");
      case 2:
        return in_.binary<std::int16_t>(swap, "a number");
      case 3:
        return in_.binary<std::uint16_t>(swap, "a number");
      case 4:
        return in_.binary<std::int32_t>(swap, "a number");
      case 5:
        return in_.binary<std::uint32_t>(swap, "a number");
      case 6:
        return static_cast<double>(in_.binary<float>(swap, "a number"));
      default:
        return in_.binary<double>(swap, "a number");
    }
  }
  [[noreturn]] void fail(const std::string& expected, const std::string& got) {
    if (encoding_ == Encoding::Text) in_.fail(expected, got);
    in_.failByte(expected, got);
  }

  void vertices(const Element& element) {
    int axes = 0;
    for (const Property& p : element.properties)
      axes += p.countType < 0 && (p.name == "x" || p.name == "y" || p.name == "z");
    if (axes != 3) fail("the properties x, y and z of a vertex", std::to_string(axes) + " of them");
    for (std::size_t i = 0; i < element.count; ++i) {
      Vec3 x;
      for (const Property& p : element.properties) {
        if (p.countType >= 0) {
          list(p);
          continue;
        }
        const double own = value(p.type);
        if (p.name.size() == 1 && p.name[0] >= 'x' && p.name[0] <= 'z') x[p.name[0] - 'x'] = own;
      }
      if (!(x.x - x.x + x.y - x.y + x.z - x.z == 0)) fail("three finite coordinates", "others");
      out_.vertices.push_back(x);
    }
  }

  std::vector<double> list(const Property& p) {
    const double count = value(p.countType);
    if (!(count >= 0 && count <= static_cast<double>(in_.left())))
      fail("a length of a list that the file has room for", std::to_string(count));
    std::vector<double> out(static_cast<std::size_t>(count));
    for (double& a : out) a = value(p.type);
    return out;
  }

  void rows(const Element& element, bool faces) {
    for (std::size_t i = 0; i < element.count; ++i)
      for (const Property& p : element.properties) {
        if (p.countType < 0) {
          value(p.type);
          continue;
        }
        const std::vector<double> numbers = list(p);
        if (!faces || (p.name != "vertex_indices" && p.name != "vertex_index")) continue;
        std::vector<int> corners;
        for (const double v : numbers) {
          if (!(v >= 0 && v < static_cast<double>(out_.vertices.size())))
            fail("indices below " + std::to_string(out_.vertices.size()), std::to_string(v));
          corners.push_back(static_cast<int>(v));
        }
        if (corners.size() < 3) fail("a face of at least three vertices", std::to_string(corners.size()));
        addPolygon(corners, out_);
      }
  }

  MeshBytes& in_;
  MeshFile out_;
  Encoding encoding_ = Encoding::Text;
  std::vector<Element> elements_;
};

}  // namespace

MeshFile readPly(MeshBytes& in) { return PlyReader(in).read(); }

}  // namespace rubble::io

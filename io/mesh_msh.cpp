/// Gmsh's MSH, versions 2.2 and 4.1 (https://gmsh.info/doc/texinfo/gmsh.html, "MSH file format"), as text and
/// binary.
#include <unordered_map>

#include "io/mesh_readers.h"

namespace rubble::io {

namespace {

// Types of elements, and how many nodes each has; those of higher order count with their corners, which come
// first.
constexpr int kNodesOfType[] = {0, 2, 3, 4, 4, 8, 6, 5, 3, 6, 9, 10, 27, 18, 14, 1};
constexpr int kElementTypes = static_cast<int>(std::size(kNodesOfType));
constexpr int kLine = 1, kTriangle = 2, kQuad = 3, kTetrahedron = 4, kLine3 = 8, kTriangle6 = 9,
              kTetrahedron10 = 11;

class MshReader {
 public:
  explicit MshReader(MeshBytes& in) : in_(in) {}

  MeshFile read() {
    bool hasFormat = false, hasNodes = false;
    while (const auto line = in_.nextLine()) {
      const std::string section(*line);
      if (section.empty() || section[0] != '$')
        in_.fail("a section (\"$Nodes\" ...)", "\"" + section.substr(0, 40) + "\"");
      if (section != "$MeshFormat" && !hasFormat)
        in_.fail("\"$MeshFormat\" before all else", "\"" + section + "\"");
      if (section == "$MeshFormat")
        format(), hasFormat = true;
      else if (section == "$Nodes")
        nodes(), hasNodes = true;
      else if (section == "$Elements") {
        if (!hasNodes) in_.fail("\"$Nodes\" before \"$Elements\"", "none");
        elements();
      } else {
        skip("$End" + section.substr(1));
        continue;
      }
      if (const auto end = in_.nextLine(); !end || *end != "$End" + section.substr(1))
        in_.fail("\"$End" + section.substr(1) + "\"",
                 end ? "\"" + std::string(end->substr(0, 40)) + "\"" : "the end of the file");
    }
    if (!hasNodes) in_.fail("a section \"$Nodes\"", "none");
    return std::move(out_);
  }

 private:
  void skip(const std::string& end) {
    while (const auto line = in_.nextLine())
      if (*line == end) return;
    in_.fail("\"" + end + "\"", "the end of the file");
  }

  void format() {
    const double version = in_.number("a version");
    if (version != 2.2 && version != 4.1) in_.fail("version 2.2 or 4.1", std::to_string(version));
    old_ = version == 2.2;
    const long long kind = in_.whole("0 (text) or 1 (binary)");
    if (kind != 0 && kind != 1) in_.fail("0 (text) or 1 (binary)", std::to_string(kind));
    binary_ = kind == 1;
    if (const long long size = in_.whole("the size of a number"); size != 8)
      in_.fail("numbers of 8 bytes", std::to_string(size));
    in_.endLine();
    if (!binary_) return;
    const auto one = in_.binary<std::int32_t>(false, "the number 1");
    swap_ = one != 1;
    constexpr std::int32_t kTurned = 1 << 24;
    if (swap_ && one != kTurned) in_.failByte("the number 1 in either byte order", std::to_string(one));
    in_.endLine();
  }

  long long whole32(const char* what) {
    return binary_ ? in_.binary<std::int32_t>(swap_, what) : in_.whole(what);
  }
  /// size_t of the format.
  long long whole64(const char* what) {
    return binary_ ? in_.binary<std::int64_t>(swap_, what) : in_.whole(what);
  }
  double real(const char* what) { return binary_ ? in_.binary<double>(swap_, what) : in_.number(what); }
  [[noreturn]] void fail(const std::string& expected, const std::string& got) {
    if (binary_) in_.failByte(expected, got);
    in_.fail(expected, got);
  }

  void node(long long tag, const Vec3& x) {
    if (!(x.x - x.x + x.y - x.y + x.z - x.z == 0)) fail("three finite coordinates", "others");
    if (!numbers_.emplace(tag, static_cast<int>(out_.vertices.size())).second)
      fail("a node number of its own", std::to_string(tag) + " again");
    out_.vertices.push_back(x);
  }
  Vec3 place() {
    Vec3 x;
    for (int axis = 0; axis < 3; ++axis) x[axis] = real("a coordinate");
    return x;
  }

  void nodes() {
    if (old_) {
      const std::size_t count = in_.count(in_.whole("the number of nodes"), 4, "a number of nodes");
      in_.endLine();
      for (std::size_t i = 0; i < count; ++i) {
        const long long tag = whole32("the number of a node");
        node(tag, place());
      }
      return;
    }
    const std::size_t blocks = in_.count(whole64("the number of blocks"), 1, "a number of blocks");
    for (int k = 0; k < 3; ++k) whole64("numbers of nodes");
    for (std::size_t b = 0; b < blocks; ++b) {
      const long long dimension = whole32("a dimension");
      whole32("an entity");
      const bool parametric = whole32("0 or 1") != 0;
      const std::size_t count = in_.count(whole64("the number of nodes"), 2, "a number of nodes");
      std::vector<long long> tags(count);
      for (long long& tag : tags) tag = whole64("the number of a node");
      for (const long long tag : tags) {
        node(tag, place());
        for (long long k = 0; parametric && k < dimension; ++k) real("a parameter");
      }
    }
  }

  int nodesOf(long long type) {
    if (type < 1 || type >= kElementTypes)
      fail("a type of elements from 1 to " + std::to_string(kElementTypes - 1), std::to_string(type));
    return kNodesOfType[type];
  }
  void element(long long type, const std::vector<long long>& tags) {
    const bool wanted = type == kLine || type == kLine3 || type == kTriangle || type == kTriangle6 ||
                        type == kQuad || type == kTetrahedron || type == kTetrahedron10;
    if (!wanted) return;
    std::vector<int> v;
    for (const long long tag : tags) {
      const auto found = numbers_.find(tag);
      if (found == numbers_.end())
        fail("the number of a node", std::to_string(tag) + ", which there is none of");
      v.push_back(found->second);
    }
    if (type == kTetrahedron || type == kTetrahedron10)
      out_.tetrahedra.push_back({v[0], v[1], v[2], v[3]});
    else if (type == kQuad)
      addPolygon(v, out_);
    else if (type == kTriangle || type == kTriangle6)
      out_.triangles.push_back({v[0], v[1], v[2]});
    else
      out_.lines.push_back({v[0], v[1]});
  }
  std::vector<long long> tagsOf(int count) {
    std::vector<long long> tags(static_cast<std::size_t>(count));
    for (long long& tag : tags)
      tag = old_ ? whole32("the number of a node") : whole64("the number of a node");
    return tags;
  }

  void elements() {
    if (!old_) {
      const std::size_t blocks = in_.count(whole64("the number of blocks"), 1, "a number of blocks");
      for (int k = 0; k < 3; ++k) whole64("numbers of elements");
      for (std::size_t b = 0; b < blocks; ++b) {
        whole32("a dimension"), whole32("an entity");
        const long long type = whole32("a type");
        const int nodes = nodesOf(type);
        const std::size_t count = in_.count(whole64("the number of elements"), 2, "a number of elements");
        for (std::size_t i = 0; i < count; ++i) {
          whole64("the number of an element");
          element(type, tagsOf(nodes));
        }
      }
      return;
    }
    const std::size_t count = in_.count(in_.whole("the number of elements"), 4, "a number of elements");
    in_.endLine();
    for (std::size_t i = 0; i < count;) {
      // text: number, type, tags; binary: a head for several of one type
      if (!binary_) in_.whole("the number of an element");
      const long long type = whole32("a type");
      const int nodes = nodesOf(type);
      const std::size_t several = binary_
                                      ? in_.count(whole32("a number of elements"), 4, "a number of elements")
                                      : 1;
      const std::size_t tags = in_.count(whole32("the number of tags"), 1, "a number of tags");
      if (several == 0) fail("at least one element", "0");
      for (std::size_t k = 0; k < several; ++k, ++i) {
        if (binary_) whole32("the number of an element");
        for (std::size_t t = 0; t < tags; ++t) whole32("a tag");
        element(type, tagsOf(nodes));
      }
    }
  }

  MeshBytes& in_;
  MeshFile out_;
  std::unordered_map<long long, int> numbers_;
  bool old_ = false, binary_ = false, swap_ = false;
};

}  // namespace

MeshFile readMsh(MeshBytes& in) { return MshReader(in).read(); }

}  // namespace rubble::io

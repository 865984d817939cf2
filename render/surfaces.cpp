#include "render/surfaces.h"

namespace rubble::render {

namespace {

struct Vertex {
  Vec3f position, normal;
  float heat;
};

}  // namespace

void Surfaces::set(std::span<const Surface> surfaces) {
  while (parts_.size() < surfaces.size()) parts_.emplace_back();
  used_ = surfaces.size();
  for (std::size_t i = 0; i < used_; ++i) {
    Part& part = parts_[i];
    const std::vector<Vec3f> normals = smoothNormals(surfaces[i].vertices, surfaces[i].triangles);
    std::vector<Vertex> interleaved;
    interleaved.reserve(normals.size());
    const std::vector<float>& heat = surfaces[i].heat;
    for (std::size_t v = 0; v < normals.size(); ++v)
      interleaved.push_back({surfaces[i].vertices[v], normals[v], heat.empty() ? 0 : heat[v]});
    glBindVertexArray(part.array.id());
    part.vertices.upload(interleaved.data(), interleaved.size() * sizeof(Vertex));
    part.indices.upload(surfaces[i].triangles.data(), surfaces[i].triangles.size() * sizeof(Triangle));
    part.indexCount = static_cast<GLsizei>(3 * surfaces[i].triangles.size());
    for (GLuint attribute = 0; attribute < 3; ++attribute) {
      glEnableVertexAttribArray(attribute);
      glVertexAttribPointer(attribute, attribute < 2 ? 3 : 1, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                            reinterpret_cast<const void*>(attribute * sizeof(Vec3f)));
    }
    glBindVertexArray(0);
  }
}

void Surfaces::draw(const DrawView& view, std::uint32_t firstSlot) {
  if (used_ == 0) return;
  gl::Program& program = view.withIds ? program_ : depths_;
  program.use();
  program.setMatrices("viewProjection", view.viewProjection.columns.data());
  for (std::size_t i = 0; i < used_; ++i) {
    program.set("surfaceSlot", static_cast<int>(firstSlot + i));
    glBindVertexArray(parts_[i].array.id());
    glDrawElements(GL_TRIANGLES, parts_[i].indexCount, GL_UNSIGNED_INT, nullptr);
  }
  glBindVertexArray(0);
}

}  // namespace rubble::render

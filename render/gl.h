#pragma once
/// Owners of OpenGL objects. All calls need the context current that the objects were made in.
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <epoxy/gl.h>

namespace rubble::render::gl {

/// Owns one object; moves, does not copy. `Kind` has make() and release(GLuint).
template <class Kind> class Handle {
 public:
  Handle() : id_(Kind::make()) {}
  ~Handle() {
    if (id_ != 0) Kind::release(id_);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  GLuint id() const { return id_; }

 private:
  GLuint id_;
};

struct BufferKind {
  static GLuint make();
  static void release(GLuint id);
};
struct TextureKind {
  static GLuint make();
  static void release(GLuint id);
};
struct FramebufferKind {
  static GLuint make();
  static void release(GLuint id);
};
struct VertexArrayKind {
  static GLuint make();
  static void release(GLuint id);
};
using VertexArray = Handle<VertexArrayKind>;

/// A buffer whose content is replaced as a whole; it keeps its room while that fits.
class Buffer {
 public:
  explicit Buffer(GLenum target) : target_(target) {}
  void upload(const void* data, std::size_t bytes);
  /// Room for `bytes` whose old content is given up; valid until unmap().
  void* map(std::size_t bytes);
  void unmap();
  /// Room for `bytes`; what was there may be lost.
  void reserve(std::size_t bytes);
  GLuint id() const { return handle_.id(); }
  /// Counts how often it got another memory.
  int storage() const { return storage_; }
  void bind() const;
  /// Where shaders find it as a block of storage; needs canCompute().
  void bindStorage(GLuint binding) const;

 private:
  Handle<BufferKind> handle_;
  GLenum target_;
  std::size_t room_ = 0;
  int storage_ = 0;
};

/// A buffer that shaders read as an array of texels.
class TexelBuffer {
 public:
  explicit TexelBuffer(GLenum format) : buffer_(GL_TEXTURE_BUFFER), format_(format) {
    buffer_.upload(nullptr, 0);
  }
  Buffer& buffer() { return buffer_; }
  void bind(int unit) const;

 private:
  Buffer buffer_;
  Handle<TextureKind> texture_;
  GLenum format_;
};

/// A picture, or with layers > 0 an array of pictures, that can be drawn to and read from.
class Texture {
 public:
  Texture(int width, int height, GLenum format, GLenum filter, int layers = 0);
  void bind(int unit) const;
  GLuint id() const { return handle_.id(); }
  GLenum target() const { return target_; }
  GLenum format() const { return format_; }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  Handle<TextureKind> handle_;
  GLenum target_, format_;
  int width_, height_;
};

/// What is drawn to. Textures must outlive it.
class Framebuffer {
 public:
  Framebuffer() = default;
  /// Throws Error if the driver cannot draw to these formats together.
  Framebuffer(const std::vector<const Texture*>& colors, const Texture* depth, int depthLayer = -1);
  void bind() const;  ///< and sets the viewport to all of it
  GLuint id() const { return handle_.id(); }

 private:
  Handle<FramebufferKind> handle_;
  int width_ = 0, height_ = 0;
};

/// Shaders that are newer than OpenGL 4.1: compute, and those that read what it wrote.
inline constexpr int kComputeVersion = 43;
/// Does the current context have them?
bool canCompute();
/// Is drawing meant to be done by compute shaders where both ways are there? Not on a software renderer.
/// RUBBLE_GL_COMPUTE=on asks for it wherever it can be, RUBBLE_GL_COMPUTE=off nowhere. Throws Error for
/// another word.
bool wantsCompute();

/// Name of the file of a compute shader.
struct ComputeFile {
  std::string name;
};

/// A linked program. Names of uniforms that the compiler has taken out are ignored.
class Program {
 public:
  /// Shaders by the name of their file in render/shaders; `defines` are put on top of both ("BOX"). `version`
  /// of OpenGL, 41 or 43. Throws Error with the driver's log.
  Program(const std::string& vertexFile, const std::string& fragmentFile,
          const std::vector<std::string>& defines = {}, int version = 41);
  explicit Program(const ComputeFile& file, const std::vector<std::string>& defines = {});
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void use() const;
  void set(const char* name, int value);
  void set(const char* name, float value);
  void set(const char* name, float x, float y);
  void set(const char* name, float x, float y, float z);
  void set(const char* name, float x, float y, float z, float w);
  void setPixels(const char* name, int x, int y);
  void setMatrices(const char* name, const float* columns, int count = 1);  ///< 4 x 4, by columns
  void setArray(const char* name, const float* values, int count);

 private:
  GLint location(const char* name);
  void attach(GLenum stage, const std::string& file, const std::vector<std::string>& defines, int version);
  void link(const std::string& files);

  GLuint id_ = 0;
  std::unordered_map<std::string, GLint> locations_;
};

/// Is the current context Mesa's software renderer?
bool drawsInSoftware();

/// Throws Error if the driver has reported a fault since the last call.
void check(const char* where);

}  // namespace rubble::render::gl

#include "render/gl.h"

#include <cstdlib>

#include <rubble/error.h>

#include "render/shader_text.h"

namespace rubble::render::gl {

GLuint BufferKind::make() {
  GLuint id = 0;
  glGenBuffers(1, &id);
  return id;
}
void BufferKind::release(GLuint id) { glDeleteBuffers(1, &id); }
GLuint TextureKind::make() {
  GLuint id = 0;
  glGenTextures(1, &id);
  return id;
}
void TextureKind::release(GLuint id) { glDeleteTextures(1, &id); }
GLuint FramebufferKind::make() {
  GLuint id = 0;
  glGenFramebuffers(1, &id);
  return id;
}
void FramebufferKind::release(GLuint id) { glDeleteFramebuffers(1, &id); }
GLuint VertexArrayKind::make() {
  GLuint id = 0;
  glGenVertexArrays(1, &id);
  return id;
}
void VertexArrayKind::release(GLuint id) { glDeleteVertexArrays(1, &id); }

void Buffer::bind() const { glBindBuffer(target_, handle_.id()); }
void Buffer::bindStorage(GLuint binding) const {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, handle_.id());
}

void Buffer::reserve(std::size_t bytes) {
  bind();
  if (bytes <= room_ && room_ > 0) return;
  ++storage_;
  room_ = std::max<std::size_t>(bytes, 16);
  glBufferData(target_, static_cast<GLsizeiptr>(room_), nullptr, GL_STREAM_DRAW);
}

void Buffer::upload(const void* data, std::size_t bytes) {
  reserve(bytes);
  if (bytes > 0) glBufferSubData(target_, 0, static_cast<GLsizeiptr>(bytes), data);
}

void* Buffer::map(std::size_t bytes) {
  reserve(bytes);
  return glMapBufferRange(target_, 0, static_cast<GLsizeiptr>(bytes),
                          GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
}

void Buffer::unmap() {
  bind();
  glUnmapBuffer(target_);
}

void TexelBuffer::bind(int unit) const {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_BUFFER, texture_.id());
  glTexBuffer(GL_TEXTURE_BUFFER, format_, buffer_.id());
}

Texture::Texture(int width, int height, GLenum format, GLenum filter, int layers)
    : target_(layers > 0 ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D),
      format_(format),
      width_(width),
      height_(height) {
  glBindTexture(target_, handle_.id());
  const bool isDepth = format == GL_DEPTH_COMPONENT32F || format == GL_DEPTH_COMPONENT24;
  const bool isInteger = format == GL_RG32UI || format == GL_R32UI;
  const GLenum outer = isDepth ? GL_DEPTH_COMPONENT : isInteger ? GL_RG_INTEGER : GL_RGBA;
  const GLenum inner = isInteger ? GL_UNSIGNED_INT : GL_FLOAT;
  const auto internal = static_cast<GLint>(format);
  if (layers > 0) {
    glTexImage3D(target_, 0, internal, width, height, layers, 0, outer, inner, nullptr);
  } else {
    glTexImage2D(target_, 0, internal, width, height, 0, outer, inner, nullptr);
  }
  glTexParameteri(target_, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(filter));
  glTexParameteri(target_, GL_TEXTURE_MAG_FILTER, static_cast<GLint>(filter));
  glTexParameteri(target_, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(target_, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  if (isDepth && layers > 0) {
    glTexParameteri(target_, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTexParameteri(target_, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  }
}

void Texture::bind(int unit) const {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(target_, handle_.id());
}

Framebuffer::Framebuffer(const std::vector<const Texture*>& colors, const Texture* depth, int depthLayer) {
  const Texture& any = colors.empty() ? *depth : *colors.front();
  width_ = any.width();
  height_ = any.height();
  glBindFramebuffer(GL_FRAMEBUFFER, handle_.id());
  std::vector<GLenum> outputs;
  for (const Texture* color : colors) {
    outputs.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(outputs.size()));
    glFramebufferTexture2D(GL_FRAMEBUFFER, outputs.back(), GL_TEXTURE_2D, color->id(), 0);
  }
  if (depth && depthLayer >= 0) {
    glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, depth->id(), 0, depthLayer);
  } else if (depth) {
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth->id(), 0);
  }
  if (outputs.empty()) {
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
  } else {
    glDrawBuffers(static_cast<GLsizei>(outputs.size()), outputs.data());
  }
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throw Error("OpenGL", "a complete framebuffer", "status " + std::to_string(status));
}

void Framebuffer::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, handle_.id());
  glViewport(0, 0, width_, height_);
}

namespace {

/// The text of a shader file with its includes put in.
std::string expanded(const std::string& file) {
  const std::string text = shaderText(file);
  const std::string mark = "#include \"";
  std::string out;
  std::size_t at = 0;
  while (true) {
    const std::size_t found = text.find(mark, at);
    out += text.substr(at, found - at);
    if (found == std::string::npos) return out;
    const std::size_t name = found + mark.size(), end = text.find('"', name);
    out += expanded(text.substr(name, end - name));
    at = end + 1;
  }
}

GLuint compile(GLenum stage, const std::string& file, const std::vector<std::string>& defines, int version) {
  std::string text = "#version " + std::to_string(10 * version) + " core\n";
  for (const std::string& define : defines) text += "#define " + define + "\n";
  text += expanded(file);
  const GLuint shader = glCreateShader(stage);
  const char* source = text.c_str();
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good == 0) {
    char log[2000] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    throw Error("shader " + file, "one that this driver compiles", log);
  }
  return shader;
}

}  // namespace

bool canCompute() { return epoxy_gl_version() >= kComputeVersion; }

bool wantsCompute() {
  const char* const choice = std::getenv("RUBBLE_GL_COMPUTE");
  const std::string word = choice ? choice : "";
  if (!word.empty() && word != "on" && word != "off") throw Error("RUBBLE_GL_COMPUTE", "on or off", word);
  return canCompute() && (word.empty() ? !drawsInSoftware() : word == "on");
}

Program::Program(const std::string& vertexFile, const std::string& fragmentFile,
                 const std::vector<std::string>& defines, int version)
    : id_(glCreateProgram()) {
  attach(GL_VERTEX_SHADER, vertexFile, defines, version);
  attach(GL_FRAGMENT_SHADER, fragmentFile, defines, version);
  link(vertexFile + " and " + fragmentFile);
}

Program::Program(const ComputeFile& file, const std::vector<std::string>& defines) : id_(glCreateProgram()) {
  attach(GL_COMPUTE_SHADER, file.name, defines, kComputeVersion);
  link(file.name);
}

void Program::attach(GLenum stage, const std::string& file, const std::vector<std::string>& defines,
                     int version) {
  const GLuint shader = compile(stage, file, defines, version);
  glAttachShader(id_, shader);
  glDeleteShader(shader);
}

void Program::link(const std::string& files) {
  glLinkProgram(id_);
  GLint good = 0;
  glGetProgramiv(id_, GL_LINK_STATUS, &good);
  if (good == 0) {
    char log[2000] = "";
    glGetProgramInfoLog(id_, sizeof log, nullptr, log);
    throw Error("shaders " + files, "ones that this driver links", log);
  }
}

Program::~Program() { glDeleteProgram(id_); }

void Program::use() const { glUseProgram(id_); }

GLint Program::location(const char* name) {
  const auto known = locations_.find(name);
  if (known != locations_.end()) return known->second;
  return locations_[name] = glGetUniformLocation(id_, name);
}

void Program::set(const char* name, int value) { glUniform1i(location(name), value); }
void Program::set(const char* name, float value) { glUniform1f(location(name), value); }
void Program::setPixels(const char* name, int x, int y) { glUniform2i(location(name), x, y); }
void Program::set(const char* name, float x, float y) { glUniform2f(location(name), x, y); }
void Program::set(const char* name, float x, float y, float z) { glUniform3f(location(name), x, y, z); }
void Program::set(const char* name, float x, float y, float z, float w) {
  glUniform4f(location(name), x, y, z, w);
}
void Program::setMatrices(const char* name, const float* columns, int count) {
  glUniformMatrix4fv(location(name), count, GL_FALSE, columns);
}
void Program::setArray(const char* name, const float* values, int count) {
  glUniform1fv(location(name), count, values);
}

bool drawsInSoftware() {
  const std::string renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  return renderer.find("llvmpipe") != std::string::npos || renderer.find("softpipe") != std::string::npos;
}

void check(const char* where) {
  const GLenum error = glGetError();
  if (error != GL_NO_ERROR)
    throw Error(std::string("OpenGL in ") + where, "no error", "error " + std::to_string(error));
}

}  // namespace rubble::render::gl

#pragma once
/// Pictures of the scenes of the registry for the picker, drawn when they are first looked at and kept.
#include <map>
#include <memory>
#include <string>

#include "io/picture.h"
#include "render/gl.h"

namespace rubble::viewer {

/// A scene as it begins, at the size of its test, in the current context of OpenGL. Throws Error for an
/// unknown scene.
io::Image thumbnailOf(const std::string& scene, int width, int height);

class Thumbnails {
 public:
  static constexpr int kWidth = 320, kHeight = 180;  ///< [pixels]
  /// The texture of a scene, rows from the top. 0 while it has been asked for too briefly to be drawn: a list
  /// that scrolls draws none. `now` [s]. Throws Error, once, for a scene that cannot be drawn.
  GLuint of(const std::string& scene, double now);
  std::size_t drawn() const { return drawn_.size(); }

 private:
  std::map<std::string, std::unique_ptr<render::gl::Texture>> drawn_;
  std::string asked_;
  double since_ = 0;  ///< when it was asked for first [s]
};

}  // namespace rubble::viewer

#pragma once
/// What the passes of a picture draw to.
#include <vector>

#include "render/gl.h"
#include "render/shadow.h"

namespace rubble::render {

/// Textures and framebuffers of one size of picture.
struct Targets {
  Targets(int width_, int height_, bool many)
      : width(width_),
        height(height_),
        ids(width, height, GL_RG32UI, GL_NEAREST),
        depths(width, height, GL_DEPTH_COMPONENT32F, GL_NEAREST),
        colors(width, height, GL_RGBA8, GL_NEAREST),
        normals(width, height, GL_RGBA16F, GL_NEAREST),
        occlusion((width + 1) / 2, (height + 1) / 2, GL_RG32F, GL_NEAREST),
        blurred((width + 1) / 2, (height + 1) / 2, GL_RG32F, GL_NEAREST),
        light(width, height, many ? GL_RGBA32F : GL_RGBA8, GL_LINEAR),
        picture(width, height, GL_RGBA8, GL_NEAREST),
        bodies({&ids}, &depths),
        material({&colors, &normals}, nullptr),
        occlusionTarget({&occlusion}, nullptr),
        blurTarget({&blurred}, nullptr),
        lightTarget({&light}, nullptr),
        pictureTarget({&picture}, nullptr) {}

  int width, height;
  gl::Texture ids, depths, colors, normals, occlusion, blurred, light, picture;
  gl::Framebuffer bodies, material, occlusionTarget, blurTarget, lightTarget, pictureTarget;
};

struct ShadowTargets {
  ShadowTargets(int size_)
      : size(size_), maps(size, size, GL_DEPTH_COMPONENT32F, GL_LINEAR, kMostShadowMaps) {
    for (int layer = 0; layer < kMostShadowMaps; ++layer)
      targets.emplace_back(std::vector<const gl::Texture*>{}, &maps, layer);
  }
  int size;
  gl::Texture maps;
  std::vector<gl::Framebuffer> targets;
};

}  // namespace rubble::render

#pragma once
/// Shared by the picture tests: a software context, a PNG reader and measures of the difference of two
/// pictures.
#include <cmath>
#include <string>
#include <vector>

#include "render/headless.h"
#include "render/stage.h"

namespace rubble::render {

/// One context for all tests of the program: the same software renderer on every machine.
HeadlessContext& softwareContext();

io::PictureBody bodyOf(const Shape& shape, const Vec3& position = {});

/// One of three bytes of a pixel.
int channel(const io::Image& image, int x, int y, int which);
/// 0 to 255.
double brightness(const io::Image& image, int x, int y);

/// Throws std::runtime_error if there is no such picture.
io::Image readPng(const std::string& file);

struct Likeness {
  double structure = 1;  ///< mean structural similarity of brightness over windows of 8 x 8 pixels, 1: the
                         ///< same (Wang et al., 2004)
  double largest = 0;    ///< largest difference of a channel after a blur over 5 x 5 pixels [of 255]
};
/// Pictures of one size.
Likeness likeness(const io::Image& a, const io::Image& b);

}  // namespace rubble::render

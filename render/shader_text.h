#pragma once
#include <string>

namespace rubble::render {

/// Text of a file of render/shaders, which the build puts into the program. Throws Error for a name that is
/// none.
std::string shaderText(const std::string& file);

}  // namespace rubble::render

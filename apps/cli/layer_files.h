#pragma once
/// Depths and normals of a picture as files.
#include <string>
#include <vector>

namespace rubble::cli {

/// Throws Error, which names `option`, unless the file ends in .npy, .exr or .png; and if it could not be
/// written now. "" is good.
void checkLayerFile(const std::string& option, const std::string& file);

/// View depths, rows from the top [m]; infinity in the sky. By the end of the file: .npy and .exr (channel Z)
/// have them as floats, .png as whole millimeters up to 65534; 65535 is what is farther, and the sky.
void writeDepths(const std::string& file, const std::vector<float>& depths, int width, int height);

/// Unit normals, three numbers per pixel, rows from the top; 0 in the sky. By the end of the file: .npy and
/// .exr (channels N.X, N.Y, N.Z) have them as floats, .png as 0 to 65534 for -1 to 1, and 0 in the sky.
void writeNormals(const std::string& file, const std::vector<float>& normals, int width, int height);

}  // namespace rubble::cli

#pragma once
/// The listings of 'rubble info' for programs.
#include <string>
#include <utility>
#include <vector>

namespace rubble::cli {

std::string scenesJson();
std::string forcesJson();
std::string deformablesJson();
std::string paramsJson();
std::string buildJson();
/// What this build and machine have for pictures and films: part and state.
std::vector<std::pair<std::string, std::string>> pictureFeatures();
std::string metricsJson();

}  // namespace rubble::cli

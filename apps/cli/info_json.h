#pragma once
/// The listings of 'rubble info' for programs.
#include <string>

namespace rubble::cli {

std::string scenesJson();
std::string forcesJson();
std::string paramsJson();
std::string buildJson();
std::string metricsJson();

}  // namespace rubble::cli

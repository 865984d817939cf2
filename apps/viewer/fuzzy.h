#pragma once
#include <string>
#include <vector>

namespace rubble::viewer {

/// How well `pattern` fits `text`: its letters must come in this order, whatever lies between; -1 if they do
/// not. Letters that follow one another or begin a word count more. Case does not matter.
int fuzzyScore(const std::string& pattern, const std::string& text);
/// Indices of the texts that fit, the best first; those that fit alike keep their order.
std::vector<std::size_t> fuzzySearch(const std::string& pattern, const std::vector<std::string>& texts);

}  // namespace rubble::viewer

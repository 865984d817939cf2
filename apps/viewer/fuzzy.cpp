#include "apps/viewer/fuzzy.h"

#include <algorithm>
#include <cctype>

namespace rubble::viewer {
namespace {

constexpr int kLetter = 1, kWordBegin = 4, kRun = 5;

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }
bool isWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

}  // namespace

int fuzzyScore(const std::string& pattern, const std::string& text) {
  // best[j]: score of the letters so far with the last of them at text[j - 1]; -1: not possible.
  std::vector<int> best(text.size() + 1, 0);
  bool first = true;
  for (const char wanted : pattern) {
    if (std::isspace(static_cast<unsigned char>(wanted))) continue;
    std::vector<int> next(text.size() + 1, -1);
    int before = first ? 0 : -1;  // best of all ends left of j - 1
    for (std::size_t j = 1; j <= text.size(); ++j) {
      if (j >= 2 && !first) before = std::max(before, best[j - 2]);
      if (lower(text[j - 1]) != lower(wanted)) continue;
      const bool wordBegin = j == 1 || !isWord(text[j - 2]);
      const int gain = kLetter + (wordBegin ? kWordBegin : 0);
      const int run = !first && best[j - 1] >= 0 ? best[j - 1] + gain + kRun : -1;
      next[j] = std::max(run, before >= 0 ? before + gain : -1);
    }
    best = std::move(next);
    first = false;
  }
  if (first) return 0;
  return *std::max_element(best.begin(), best.end());
}

std::vector<std::size_t> fuzzySearch(const std::string& pattern, const std::vector<std::string>& texts) {
  std::vector<std::pair<int, std::size_t>> found;
  for (std::size_t i = 0; i < texts.size(); ++i)
    if (const int score = fuzzyScore(pattern, texts[i]); score >= 0) found.emplace_back(score, i);
  // Among equal scores the shorter text fits better.
  std::stable_sort(found.begin(), found.end(), [&](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : texts[a.second].size() < texts[b.second].size();
  });
  std::vector<std::size_t> order;
  for (const auto& [score, index] : found) order.push_back(index);
  return order;
}

}  // namespace rubble::viewer

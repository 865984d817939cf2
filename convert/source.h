#pragma once
/// The XML files of one import. They are read with limits, included files take the place of the elements that
/// include them, and every element and attribute that was read is marked. What is not marked is reported.
#include <deque>
#include <filesystem>
#include <set>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include <pugixml.hpp>

#include "convert/folders.h"

namespace rubble::convert {

class Source {
 public:
  explicit Source(Folders& folders) : folders_(folders) {}
  Source(const Source&) = delete;

  /// Root element of a file. `who` is named in errors. Throws Error with line and column of a syntax error,
  /// and for document types (entities), files above the size limit and elements nested too deeply.
  pugi::xml_node load(const std::filesystem::path& file, const std::string& who);
  /// Root element of a text, for tests. `file`: its name in places.
  pugi::xml_node loadText(const std::string& text, const std::string& file);

  /// Elements below `parent`. MJCF: those of an included file stand in place of <include>. A file that is
  /// included twice, which a cycle always does, is an Error.
  std::vector<pugi::xml_node> children(pugi::xml_node parent);
  std::vector<pugi::xml_node> children(pugi::xml_node parent, const std::string& name);

  Place place(pugi::xml_node node) const;
  /// "robot.xml:12: joint"
  std::string path(pugi::xml_node node) const { return place(node).text() + ": " + node.name(); }
  /// Folder of the first file.
  const std::filesystem::path& home() const { return home_; }
  Folders& folders() { return folders_; }

  void use(pugi::xml_node node) { used_.insert(node.internal_object()); }
  void use(pugi::xml_attribute attribute) { used_.insert(attribute.internal_object()); }
  bool isUsed(pugi::xml_node node) const { return used_.contains(node.internal_object()); }
  bool isUsed(pugi::xml_attribute attribute) const { return used_.contains(attribute.internal_object()); }

  /// Attributes that the reader asks for: "joint.range".
  void know(const std::string& attribute) { known_.insert(attribute); }
  bool knows(const std::string& attribute) const { return known_.contains(attribute); }

  /// Root elements of all files.
  std::vector<pugi::xml_node> roots() const;

 private:
  struct File {
    pugi::xml_document document;
    std::string name;
    std::vector<std::ptrdiff_t> lines;  ///< byte at which each line begins
  };

  pugi::xml_node parse(const std::string& text, const std::string& name);
  pugi::xml_node included(pugi::xml_node include);

  Folders& folders_;
  std::filesystem::path home_;
  std::deque<File> files_;
  std::unordered_map<const void*, std::size_t> fileOfRoot_;
  std::unordered_map<const void*, pugi::xml_node> rootOfInclude_;
  std::set<std::filesystem::path> loaded_;
  std::unordered_set<const void*> used_;
  std::set<std::string> known_;
};

}  // namespace rubble::convert

#pragma once
/// Notes of the elements and attributes that an import did not read.
#include <functional>
#include <map>
#include <string>

#include "convert/report.h"
#include "convert/source.h"

namespace rubble::convert {

struct Reason {
  Effect effect;
  const char* why;
};
using Reasons = std::map<std::string, Reason, std::less<>>;

/// What is known of the words of a format. A word that is in none of the lists is lost.
struct Words {
  const Reasons& elements;    ///< not converted, with everything in them
  const Reasons& attributes;  ///< "geom.margin"
  const Reasons& anywhere;    ///< attributes of any element
};

/// Visits every file of the import.
void noteUnused(const Source& source, const Words& words, Report& report);

}  // namespace rubble::convert

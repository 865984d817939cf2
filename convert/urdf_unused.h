#pragma once
#include "convert/report.h"
#include "convert/source.h"

namespace rubble::convert {

/// Notes every element and attribute of a URDF import that was not used.
void noteUnusedUrdf(const Source& source, Report& report);

}  // namespace rubble::convert

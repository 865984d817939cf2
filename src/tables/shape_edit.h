#pragma once
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

/// A cooked shape in the solver precision.
ShapeData shapeData(const CookedData& shape);

}  // namespace rubble::RUBBLE_CORE

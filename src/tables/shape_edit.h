#pragma once
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

/// A cooked shape in the precision of the tables.
ShapeData shapeData(const CookedData& shape);

}  // namespace rubble::RUBBLE_CORE

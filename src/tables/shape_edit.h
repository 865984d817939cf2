#pragma once
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

/// A cooked shape in the solver precision.
ShapeData shapeData(const CookedData& shape);
/// Sets SolverData::oneWay.
void findOneWay(SolverData& s);

}  // namespace rubble::RUBBLE_CORE

/// In single precision, whatever the other tests of this program take.
#undef RUBBLE_CORE
#undef RUBBLE_REAL
#define RUBBLE_CORE f32
#define RUBBLE_REAL float
#define RUBBLE_TRIG_SUITE TrigInFloat
#include "tests/math/trig_cases.h"

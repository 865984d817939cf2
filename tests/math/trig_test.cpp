/// In double precision.
#define RUBBLE_TRIG_SUITE TrigInDouble
#include "tests/math/trig_cases.h"

// Allowed: level 0 and itself. Broken: looks upwards; relative path.
#include "errors.h"
#include <pcs/concepts.h>
#include <pcs/core/errors.h>
#include <pcs/neighborhood/graph.h>

// Allowed: level 0. Broken: looks upwards.
#include <pcs/Named_function_parameters.h>
#include <pcs/core/errors.h>

// Allowed: all stages. Broken: IO.
#include <pcs/IO/read.h>
#include <pcs/deformation/sampling.h>

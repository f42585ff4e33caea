// Allowed: lower levels, its own internal folder. Broken: a sibling, the internal folder of another.
#include <pcs/deformation/internal/grid.h>
#include <pcs/neighborhood/graph.h>
#include <pcs/neighborhood/internal/tree.h>
#include <pcs/skeleton/slices.h>

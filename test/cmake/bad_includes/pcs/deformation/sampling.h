// Allowed: lower levels. Broken: a sibling, the internal folder of another, a room that is not listed.
#include <pcs/deformation/internal/grid.h>
#include <pcs/neighborhood/graph.h>
#include <pcs/neighborhood/internal/tree.h>
#include <pcs/skeleton/slices.h>

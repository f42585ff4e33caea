// Allowed: the model, its own room, a door of the table. Broken: a room that the table does not name.

#include <pcs/skeleton/axes/chain.h>
#include <pcs/skeleton/branching/join.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/model/Axis.h>

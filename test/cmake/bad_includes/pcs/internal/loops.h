// Broken: the two headers that include everything.
#include <CGAL/basic.h>

#include <tbb/tbb.h>

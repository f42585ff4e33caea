// Broken: its sibling; a CGAL package under the GPL; oneTBB outside parallel.h.
#include <pcs/linear_algebra/laplacian.h>

#include <CGAL/Search_traits_3.h>

#include <tbb/parallel_for.h>

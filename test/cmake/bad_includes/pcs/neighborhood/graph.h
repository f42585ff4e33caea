// Broken: its sibling; a CGAL package under the GPL.
#include <pcs/linear_algebra/laplacian.h>

#include <CGAL/Search_traits_3.h>

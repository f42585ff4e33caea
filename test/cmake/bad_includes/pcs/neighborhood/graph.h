// Broken: its sibling; a CGAL package under the GPL.
#include <CGAL/Search_traits_3.h>
#include <pcs/linear_algebra/laplacian.h>

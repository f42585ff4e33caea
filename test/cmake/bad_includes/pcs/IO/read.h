// Allowed: GPL packages of CGAL. No broken rule here.
#include <pcs/core/errors.h>

#include <CGAL/Point_set_3.h>

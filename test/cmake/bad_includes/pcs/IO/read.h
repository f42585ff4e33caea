// Allowed: GPL packages of CGAL. No broken rule here.
#include <CGAL/Point_set_3.h>
#include <pcs/core/errors.h>

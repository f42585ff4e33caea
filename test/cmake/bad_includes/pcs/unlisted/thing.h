// Broken: a folder that the table does not know.
#include <pcs/core/errors.h>

#include "core/base/decompositions.h"

IDIM_DECOMPOSITIONS(template);

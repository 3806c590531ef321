// Compiles the header that all tests share, once.
#include "tests/support/catch.h"

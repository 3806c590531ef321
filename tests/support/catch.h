// One name for both generations of Catch2: 2.13 (Debian 12) and 3 (Ubuntu 24.04).
#pragma once
#if GONOGO_CATCH2 >= 3
#include <catch2/catch_all.hpp>
using Catch::Approx;
#else
#include <catch2/catch.hpp>
#endif

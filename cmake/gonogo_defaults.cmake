# What every target of this project is compiled with.
#
#   gonogo_library(<name> SOURCES <cpp>... [LINK <public>...] [LINK_PRIVATE <private>...])
#   gonogo_defaults(<target>)
#   gonogo_unite(<target>)                        its sources are compiled together where GONOGO_UNITY is on
#   gonogo_precompile(<target> <header>)          compiles a header once that all files of the target include
#   gonogo_precompile(<target> FROM <target>)     takes that of another target
#
# A folder that sets gonogo_runs_briefly is compiled with -O1 in release builds, in half the time.
#
# Arithmetic is strict so that results do not depend on compiler version or thread count: no contraction
# into fused multiply-adds, no reassociation. CUDA gets the same promise by -fmad=false (base/CMakeLists.txt).

find_package(Threads REQUIRED)
find_package(OpenMP REQUIRED COMPONENTS CXX)

if(GONOGO_CUDA)
  # Code for Ampere (80, 86, 89 run it) and Hopper (90), and PTX that later GPUs translate at the first start.
  if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES AND NOT DEFINED ENV{CUDAARCHS})
    set(CMAKE_CUDA_ARCHITECTURES "80;90" CACHE STRING "Compute capabilities to build for")
  endif()
  enable_language(CUDA)
endif()

function(gonogo_defaults target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>")
  set(host_flags -Wall -Wextra -ffp-contract=off)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    list(APPEND host_flags -Wshadow=local)  # Clang knows no such level
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    list(APPEND host_flags -Wno-restrict)  # GCC bug 105651: false alarms about "literal" + std::string
  endif()
  if(NOT CMAKE_CXX_FLAGS MATCHES "-march=")
    list(APPEND host_flags -Wno-psabi)  # packs of eight numbers are passed inside one build only
  endif()
  if(gonogo_runs_briefly AND CMAKE_BUILD_TYPE STREQUAL "Release")
    list(APPEND host_flags -O1)
  endif()
  if(GONOGO_WERROR)
    list(APPEND host_flags -Werror)
  endif()
  target_compile_options(${target} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:${host_flags}>")
  if(GONOGO_CUDA)
    target_compile_options(${target} PRIVATE
      "$<$<COMPILE_LANGUAGE:CUDA>:-fmad=false;--expt-relaxed-constexpr;-Xcompiler=-ffp-contract=off>")
  endif()
endfunction()

# Sources of one target that are compiled together. Two files of a target may not define one name in anonymous namespaces.
option(GONOGO_UNITY "Compile up to 12 sources of a target at once: whole builds are faster, builds after a change slower" OFF)
function(gonogo_unite target)
  if(GONOGO_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 12)
  endif()
endfunction()

function(gonogo_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;LINK_PRIVATE" ${ARGN})
  add_library(gonogo_${name} STATIC ${ARG_SOURCES})
  add_library(gonogo::${name} ALIAS gonogo_${name})
  gonogo_defaults(gonogo_${name})
  gonogo_unite(gonogo_${name})
  # For shared libraries of users and for the Python module. Hidden names are called directly, as in a program.
  set_target_properties(gonogo_${name} PROPERTIES
    POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_link_libraries(gonogo_${name} PUBLIC ${ARG_LINK} PRIVATE ${ARG_LINK_PRIVATE})
endfunction()

# Only for headers that every file includes anyway: no file may compile because of it alone.
option(GONOGO_PRECOMPILE "Compile large headers once; OFF for compiler caches that cannot" ON)
function(gonogo_precompile target header)
  if(NOT GONOGO_PRECOMPILE)
    return()
  elseif(header STREQUAL "FROM")
    target_precompile_headers(${target} REUSE_FROM ${ARGV2})
  else()
    target_precompile_headers(${target} PRIVATE "${PROJECT_SOURCE_DIR}/${header}")
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>")  # what ccache needs
    if(CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)  # GCC bug 105651 again, which knows no system headers here
      target_compile_options(${target} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:-Wno-stringop-overflow;-Wno-array-bounds>")
    endif()
  endif()
endfunction()

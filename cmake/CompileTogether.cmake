# The files of a folder are compiled in groups (CAMBER_UNITY), and headers that nearly every file includes are read once.
# Files that somebody works on are compiled alone, so that a change costs one file: scripts/build writes their names to
# alone.txt in the build folder.
include(${CMAKE_CURRENT_LIST_DIR}/UnityGroups.cmake)
if(CAMBER_UNITY)
  find_package(Python3 COMPONENTS Interpreter)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/unity_groups.py)
endif()
if(CAMBER_UNITY AND Python3_FOUND)
  file(WRITE ${PROJECT_BINARY_DIR}/headers.cpp "")
  set(headers <algorithm> <array> <cmath> <filesystem> <fstream> <functional> <limits> <map> <memory> <numbers>
    <numeric> <optional> <set> <span> <sstream> <string> <string_view> <unordered_map> <variant> <vector> <Eigen/Core>
    <Eigen/Geometry> <fmt/format.h>)
  # g++ takes the optimization of the headers for the files that include them, whatever these ask for: one set for each.
  function(camber_headers name)
    add_library(${name} STATIC ${PROJECT_BINARY_DIR}/headers.cpp)
    target_link_libraries(${name} PRIVATE camber_options TBB::tbb fmt::fmt)
    target_compile_options(${name} PRIVATE ${ARGN})
    target_precompile_headers(${name} PRIVATE ${headers} <tbb/parallel_for.h>)
  endfunction()
  camber_headers(camber_headers)
  camber_headers(camber_light_headers $<$<CONFIG:Release>:-O1>)
  if(CAMBER_TESTS)
    # Precompiled headers ask for the same optimization.
    find_package(GTest REQUIRED)
    function(camber_test_headers name optimization)
      add_library(${name} STATIC ${PROJECT_BINARY_DIR}/headers.cpp)
      target_link_libraries(${name} PRIVATE camber_options fmt::fmt GTest::gtest)
      target_compile_options(${name} PRIVATE -fPIC ${optimization})
      target_precompile_headers(${name} PRIVATE ${headers} <gtest/gtest.h> <nlohmann/json.hpp>)
    endfunction()
    camber_test_headers(camber_plain_test_headers -O0)
    camber_test_headers(camber_light_test_headers $<$<CONFIG:Release>:-O1>)
  endif()
endif()

# Names of theirs stand in headers that others of their folder include.
set(CAMBER_COMPILED_ALONE report/page_bundle.cpp ui/workbench_bundle.cpp ui/server.cpp tests/calib/fit_stretches_test.cpp tests/repath/resegment_test.cpp)

# camber_compile_together(TARGET HEADERS): files of a group have no local name in common. HEADERS: the target whose
# precompiled headers it takes.
function(camber_compile_together target headers)
  if(NOT CAMBER_UNITY OR NOT Python3_FOUND)
    return()
  endif()
  get_target_property(files ${target} SOURCES)
  list(FILTER files INCLUDE REGEX "\\.cpp$")
  list(FILTER files EXCLUDE REGEX "/simd/")
  set(alone ${CAMBER_COMPILED_ALONE})
  set(changed ${PROJECT_BINARY_DIR}/alone.txt)
  if(EXISTS ${changed})
    file(STRINGS ${changed} more)
    list(APPEND alone ${more})
  endif()
  foreach(file IN LISTS alone)
    list(REMOVE_ITEM files ${PROJECT_SOURCE_DIR}/${file})
    set_source_files_properties(${PROJECT_SOURCE_DIR}/${file} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endforeach()
  camber_group(${target} 2600 ${files})
  # A group's file is no header, though the compiler takes what it includes for one.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  target_compile_options(${target} PRIVATE -fPIC)  # tests too: precompiled headers ask for the same flags
  # Those of removal differ: OpenVDB's templates are visible there.
  if(NOT target STREQUAL "camber_removal")
    target_precompile_headers(${target} REUSE_FROM ${headers})
  endif()
endfunction()

# The same with less optimization.
function(camber_compile_lightly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  camber_compile_together(${target} camber_light_headers)
endfunction()

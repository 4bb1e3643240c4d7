# SPDX-License-Identifier: Apache-2.0
# One helper for every room, so that a room's CMakeLists.txt is only a list of what it is made of.
include_guard(GLOBAL)
include(GNUInstallDirs)
find_package(Threads REQUIRED)

set(MESO_WARNINGS -Wall -Wextra -Wno-missing-field-initializers -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual)
if(MESO_WARNINGS_AS_ERRORS)
  list(APPEND MESO_WARNINGS -Werror)
endif()
find_program(MESO_CCACHE ccache)
if(MESO_CCACHE AND PROJECT_IS_TOP_LEVEL AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${MESO_CCACHE}")
endif()
if(PROJECT_IS_TOP_LEVEL)
  set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
endif()

# Same document, same bytes: no fused multiply-add behind our back, no compiler dialect.
function(meso_compile_settings target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  target_compile_options(${target} PRIVATE ${MESO_WARNINGS} -ffp-contract=off)
endfunction()

# room(<name> SOURCES ... USES <rooms> PRIVATE <third-party targets>)
#   target meso_<name>, alias meso::<name>; public headers in <folder>/include.
function(room name)
  cmake_parse_arguments(ARG "" "" "SOURCES;USES;PRIVATE" ${ARGN})
  add_library(meso_${name} STATIC ${ARG_SOURCES})
  add_library(meso::${name} ALIAS meso_${name})
  meso_compile_settings(meso_${name})
  target_include_directories(meso_${name} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  list(TRANSFORM ARG_USES PREPEND meso::)
  target_link_libraries(meso_${name} PUBLIC ${ARG_USES} PRIVATE ${ARG_PRIVATE})
endfunction()

# room_tests(<name> SOURCES ... USES <rooms> [PRIVATE <targets>] [LABELS ...])
#   one GoogleTest executable meso_<name>_tests; label = room; MESO_SOURCE_DIR points at the checkout.
function(room_tests name)
  if(NOT MESO_WITH_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;USES;PRIVATE;LABELS" ${ARGN})
  add_executable(meso_${name}_tests ${ARG_SOURCES})
  meso_compile_settings(meso_${name}_tests)
  list(TRANSFORM ARG_USES PREPEND meso::)
  target_link_libraries(meso_${name}_tests PRIVATE ${ARG_USES} ${ARG_PRIVATE} GTest::gtest_main GTest::gmock)
  target_include_directories(meso_${name}_tests PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_compile_definitions(meso_${name}_tests PRIVATE MESO_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  add_test(NAME ${name} COMMAND meso_${name}_tests)
  set_tests_properties(${name} PROPERTIES LABELS "${name};${ARG_LABELS}" TIMEOUT 600)
endfunction()

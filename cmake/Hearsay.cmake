# One CMake target a folder, all with the same rules.

include(GNUInstallDirs)

option(HEARSAY_WARNINGS_AS_ERRORS "Treat compiler warnings as errors" OFF)
set(HEARSAY_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined")

# What computes a run must give the same bits everywhere: no fused multiply-add chosen by the
# compiler, no vector reductions whose order depends on an address, no machine-specific code.
add_library(hearsay_rules INTERFACE)
target_compile_features(hearsay_rules INTERFACE cxx_std_20)
target_compile_definitions(hearsay_rules INTERFACE EIGEN_DONT_VECTORIZE)
install(TARGETS hearsay_rules EXPORT hearsay)

add_library(hearsay_private_rules INTERFACE)
target_compile_options(hearsay_private_rules INTERFACE
  -ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wimplicit-fallthrough -Wno-missing-field-initializers
  $<$<BOOL:${HEARSAY_WARNINGS_AS_ERRORS}>:-Werror>)
if(HEARSAY_SANITIZE)
  target_compile_options(hearsay_private_rules INTERFACE
    -fsanitize=${HEARSAY_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${HEARSAY_SANITIZE})
endif()

# hearsay_library(kernel SOURCES a.cpp PUBLIC hearsay_math PRIVATE xxhash)
function(hearsay_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target hearsay_${name})
  add_library(${target} STATIC ${arg_SOURCES})
  add_library(hearsay::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/hearsay>)
  target_link_libraries(${target} PUBLIC hearsay_rules ${arg_PUBLIC}
    PRIVATE $<BUILD_INTERFACE:hearsay_private_rules> ${arg_PRIVATE})
  install(TARGETS ${target} EXPORT hearsay)
endfunction()

# hearsay_test(kernel SOURCES a_test.cpp LIBRARIES hearsay_kernel [LABELS fast])
# One executable a room; its tests are found by ctest one by one. NEEDS_SOURCE: those of the sources that read
# files below HEARSAY_SOURCE_DIR. (All others compile to the same object in every clone.)
function(hearsay_test name)
  cmake_parse_arguments(arg "" "" "SOURCES;LIBRARIES;LABELS;NEEDS_SOURCE" ${ARGN})
  set(target ${name}_test)
  add_executable(${target} ${arg_SOURCES})
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
  if(arg_NEEDS_SOURCE)
    set_source_files_properties(${arg_NEEDS_SOURCE} PROPERTIES
      COMPILE_DEFINITIONS HEARSAY_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  endif()
  target_link_libraries(${target} PRIVATE hearsay_private_rules ${arg_LIBRARIES} GTest::gtest_main
    GTest::gmock)
  gtest_discover_tests(${target} PROPERTIES LABELS "${arg_LABELS}" DISCOVERY_TIMEOUT 60
    TEST_PREFIX ${name}.)
endfunction()

# sonarcal_add_library(NAME SOURCES ... PUBLIC_LINKS ... PRIVATE_LINKS ... PRECOMPILE ...)
#
# A room of the house: target sonarcal_NAME, alias sonarcal::NAME, headers included as
# "NAME/header.h" in the tree and, once installed, from the same root under include/sonarcal.
function(sonarcal_add_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC_LINKS;PRIVATE_LINKS;PRECOMPILE" ${ARGN})
  set(target sonarcal_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(sonarcal::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/sonarcal>)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC_LINKS} PRIVATE ${ARG_PRIVATE_LINKS})
  sonarcal_compile_options(${target})
  sonarcal_unify(${target})
  target_precompile_headers(${target} PRIVATE ${ARG_PRECOMPILE})
  set_property(GLOBAL APPEND PROPERTY SONARCAL_LIBRARIES ${target})
endfunction()

# Sanitizers as -fsanitize takes them; empty without sanitizers.
set(SONARCAL_SANITIZERS "")
if(SONARCAL_SANITIZE MATCHES "^(address|ON|on|TRUE|true|YES|yes|1)$")
  set(SONARCAL_SANITIZERS address,undefined)
elseif(SONARCAL_SANITIZE STREQUAL thread)
  set(SONARCAL_SANITIZERS thread)
elseif(SONARCAL_SANITIZE)
  message(FATAL_ERROR "SONARCAL_SANITIZE is '${SONARCAL_SANITIZE}', expected OFF, address (or ON) or thread")
endif()

# The habits every target of the project shares.
function(sonarcal_compile_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
    -Wno-sign-conversion -Wnon-virtual-dtor -Woverloaded-virtual)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION MATCHES "^13")
    # GCC 13 warns of these where nothing is wrong: inlined decompositions of Eigen, references that a function
    # returns from its argument, and buffers of fmt.
    target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized -Wno-dangling-reference -Wno-array-bounds
      -Wno-stringop-overflow)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
    # GCC notes wherever std::pair<double, double> is passed that GCC 10 changed the way.
    target_compile_options(${target} PRIVATE -Wno-psabi)
  endif()
  if(SONARCAL_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(SONARCAL_FUZZ)
    target_compile_options(${target} PUBLIC -fsanitize=fuzzer-no-link)
  endif()
  if(SONARCAL_SANITIZERS)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      # GCC's manual: sanitizers make this warning wrong. It names std::regex here.
      target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized)
    endif()
    target_compile_options(${target} PUBLIC -fsanitize=${SONARCAL_SANITIZERS} -fno-sanitize-recover=undefined
      -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${SONARCAL_SANITIZERS})
  endif()
  if(SONARCAL_SANITIZERS OR SONARCAL_FUZZ)
    # Sanitizers see neither an empty std::optional that is read nor an index between a vector's size and its capacity.
    target_compile_definitions(${target} PUBLIC _GLIBCXX_ASSERTIONS)
  endif()
endfunction()

# sonarcal_optimise_little(TARGET): for command lines, JSON, pages and tests. There, more optimisation doubles the
# build time and saves no time at run time.
function(sonarcal_optimise_little target)
  target_compile_options(${target} PRIVATE $<$<NOT:$<CONFIG:Debug>>:-O1>)
endfunction()

# sonarcal_unify(TARGET): compiles twelve sources of the target at a time, where SONARCAL_UNITY is on. The sources use the
# same templates of Eigen, JSON and GoogleTest. The compiler then compiles each template once for all of them. Two sources
# of one target must not define the same name in their unnamed namespaces. Overloads of a function are allowed. A
# constant of a source must not have the name of a header's constant, because it would hide that from the other sources.
function(sonarcal_unify target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${SONARCAL_UNITY} UNITY_BUILD_BATCH_SIZE 12)
  if(SONARCAL_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # This warning is about headers, and GCC takes an included source for one.
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  endif()
endfunction()

# sonarcal_vectorise(SOURCE): loops over arrays, which the compiler turns into vector instructions.
#
# Not by -ffast-math: infinities and NaN keep their meaning, and no reciprocal or root is an estimate, which
# differs from processor to processor. glibc declares its vector functions (exp, log, ...) only where
# __FAST_MATH__ is defined.
function(sonarcal_vectorise source)
  set_source_files_properties(${source} PROPERTIES
    COMPILE_OPTIONS "-O3;-fno-math-errno;-fno-trapping-math;-fno-signed-zeros;-Wno-psabi"
    COMPILE_DEFINITIONS __FAST_MATH__
    SKIP_PRECOMPILE_HEADERS ON)
endfunction()

# sonarcal_add_test(NAME SOURCES ... LINKS ... [LABEL quick|slow]): one GoogleTest program for one folder of tests.
#
# LABEL quick: part of `scripts/test.sh --quick`, so libraries above metrics are not allowed in LINKS.
# LABEL slow: the program takes more than 40 seconds. The time limit ends only tests that hang.
function(sonarcal_add_test name)
  cmake_parse_arguments(ARG "" "LABEL" "SOURCES;LINKS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINKS} sonarcal_test_support sonarcal_test_main)
  sonarcal_compile_options(${name})
  sonarcal_optimise_little(${name})
  sonarcal_unify(${name})
  target_precompile_headers(${name} REUSE_FROM sonarcal_test_headers)
  set(time_limit_s 3000)
  if(SONARCAL_SANITIZERS)
    set(time_limit_s 30000)
  endif()
  set(properties "TIMEOUT ${time_limit_s} SKIP_RETURN_CODE 77")
  if(ARG_LABEL)
    string(APPEND properties " LABELS ${ARG_LABEL}")
  endif()
  set(suites ${CMAKE_CURRENT_BINARY_DIR}/${name}_suites.cmake)
  add_custom_command(TARGET ${name} POST_BUILD
    COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:${name}> -DNAME=${name} -DOUTPUT=${suites} -DPROPERTIES=${properties}
      "-DEMULATOR=${CMAKE_CROSSCOMPILING_EMULATOR}"
      -P ${PROJECT_SOURCE_DIR}/cmake/SonarcalDiscoverTests.cmake
    BYPRODUCTS ${suites}
    VERBATIM)
  # A program that is not built has one test, which fails.
  set(include_file ${CMAKE_CURRENT_BINARY_DIR}/${name}_include.cmake)
  file(WRITE ${include_file}
    "if(EXISTS \"${suites}\")\n  include(\"${suites}\")\nelse()\n  add_test(${name}_NOT_BUILT ${name}_NOT_BUILT)\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${include_file})
  if(ARG_LABEL STREQUAL quick)
    add_dependencies(quick_tests ${name})
  endif()
endfunction()

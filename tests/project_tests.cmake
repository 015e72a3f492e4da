# Tests of the project itself rather than of its code: the walls between rooms, the format of the sources, the
# scripts, and the package as others use it.
find_package(Python REQUIRED COMPONENTS Interpreter)

add_test(NAME layering COMMAND Python::Interpreter ${PROJECT_SOURCE_DIR}/tests/layering_test.py ${PROJECT_SOURCE_DIR})
add_test(NAME layering_self_test
  COMMAND Python::Interpreter ${PROJECT_SOURCE_DIR}/tests/layering_test.py --self-test)
add_test(NAME english COMMAND Python::Interpreter ${PROJECT_SOURCE_DIR}/tests/english_test.py ${PROJECT_SOURCE_DIR})
add_test(NAME english_self_test
  COMMAND Python::Interpreter ${PROJECT_SOURCE_DIR}/tests/english_test.py --self-test)
set_tests_properties(layering layering_self_test english english_self_test PROPERTIES LABELS quick)

# Versions of clang-format disagree; this one is Debian 12's.
find_program(SONARCAL_CLANG_FORMAT clang-format-14)
if(SONARCAL_CLANG_FORMAT)
  add_test(NAME format COMMAND ${PROJECT_SOURCE_DIR}/scripts/format.sh --check)
endif()

find_program(SONARCAL_SHELLCHECK shellcheck)
if(SONARCAL_SHELLCHECK)
  file(GLOB SONARCAL_SCRIPTS CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/scripts/*.sh)
  add_test(NAME shellcheck
    COMMAND ${SONARCAL_SHELLCHECK} --external-sources ${SONARCAL_SCRIPTS} ${PROJECT_SOURCE_DIR}/.ci/run
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
endif()

# Time limits. Only a test that hangs reaches them.
set(limit_s 600)
set(guide_limit_s 1200)
set(consumer_flags "-Wall")
if(SONARCAL_SANITIZERS)
  set(limit_s 6000)
  set(guide_limit_s 12000)
  string(APPEND consumer_flags " -fsanitize=${SONARCAL_SANITIZERS}")
endif()
add_test(NAME consumer
  COMMAND ${CMAKE_COMMAND} -DBUILD_DIR=${PROJECT_BINARY_DIR} -DSOURCE_DIR=${PROJECT_SOURCE_DIR}/tests/consumer
    -DGENERATOR=${CMAKE_GENERATOR} -DCXX=${CMAKE_CXX_COMPILER} -DFLAGS=${consumer_flags}
    -P ${PROJECT_SOURCE_DIR}/tests/consumer/run.cmake)
set_tests_properties(consumer PROPERTIES TIMEOUT ${limit_s})

# The program as it is installed and described: its package, its manual pages and completion, its guide.
if(SONARCAL_BUILD_APPS)
  add_test(NAME documentation
    COMMAND Python::Interpreter ${PROJECT_SOURCE_DIR}/tests/documentation_test.py $<TARGET_FILE:sonarcal>)
  add_test(NAME guide
    COMMAND Python::Interpreter ${PROJECT_SOURCE_DIR}/tests/guide_test.py ${PROJECT_SOURCE_DIR}/docs/guide
      $<TARGET_FILE:sonarcal>)
  set_tests_properties(guide PROPERTIES TIMEOUT ${guide_limit_s})
  add_test(NAME guide_self_test
    COMMAND Python::Interpreter ${PROJECT_SOURCE_DIR}/tests/guide_test.py --self-test)
  add_test(NAME schema
    COMMAND Python::Interpreter ${PROJECT_SOURCE_DIR}/tests/schema_test.py $<TARGET_FILE:sonarcal>
      $<TARGET_FILE:sonarcal_read_documents>)
  set_tests_properties(schema PROPERTIES TIMEOUT ${limit_s})
  add_test(NAME make_aris3000_recording
    COMMAND Python::Interpreter ${PROJECT_SOURCE_DIR}/tests/make_aris3000_recording_test.py
      $<TARGET_FILE:sonarcal>)
  add_test(NAME licence
    COMMAND Python::Interpreter ${PROJECT_SOURCE_DIR}/tests/licence_test.py ${PROJECT_BINARY_DIR}
      $<TARGET_FILE:sonarcal> ${CMAKE_COMMAND} ${CMAKE_GENERATOR})
  if(NOT SONARCAL_SANITIZE)
    add_test(NAME package
      COMMAND Python::Interpreter ${PROJECT_SOURCE_DIR}/tests/package_test.py ${PROJECT_BINARY_DIR}
        ${CMAKE_CPACK_COMMAND})
    set_tests_properties(package PROPERTIES TIMEOUT ${limit_s})
  endif()
  if(SONARCAL_DOXYGEN)
    add_test(NAME api_reference
      COMMAND Python::Interpreter ${PROJECT_SOURCE_DIR}/tests/api_reference_test.py ${SONARCAL_DOXYGEN}
        ${PROJECT_BINARY_DIR}/Doxyfile)
    set_tests_properties(api_reference PROPERTIES TIMEOUT ${limit_s})
  endif()
  if(SONARCAL_DOCS_SITE)
    add_test(NAME docs_site
      COMMAND Python::Interpreter ${PROJECT_SOURCE_DIR}/tests/docs_site_test.py ${PROJECT_BINARY_DIR}
        ${SONARCAL_DOCS_SITE})
    set_tests_properties(docs_site PROPERTIES TIMEOUT ${limit_s})
  endif()
endif()

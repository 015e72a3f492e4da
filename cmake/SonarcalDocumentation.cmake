# Manual pages and shell completion, written by the program from its own commands, the reference of the
# libraries (target `docs`, needs Doxygen), and the site of all pages with both references (target `docs_site`).
set(documentation_dir ${PROJECT_BINARY_DIR}/documentation)
add_custom_command(OUTPUT ${documentation_dir}/sonarcal.1
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${documentation_dir}
  COMMAND sonarcal documentation --quiet --out ${documentation_dir}
  COMMAND sh -c "gzip -9nk ${documentation_dir}/*.1"
  DEPENDS sonarcal
  COMMENT "Writing manual pages and completion"
  VERBATIM)
add_custom_target(manual_pages ALL DEPENDS ${documentation_dir}/sonarcal.1)

install(DIRECTORY ${documentation_dir}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program
  FILES_MATCHING PATTERN "*.1.gz")
install(FILES ${documentation_dir}/sonarcal.bash
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME sonarcal COMPONENT program)
install(FILES ${documentation_dir}/_sonarcal
  DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)
install(FILES ${documentation_dir}/sonarcal.fish
  DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/cases DESTINATION ${CMAKE_INSTALL_DATADIR}/sonarcal COMPONENT program)
install(PROGRAMS ${PROJECT_SOURCE_DIR}/apps/batch/dask_batch.py
  DESTINATION ${CMAKE_INSTALL_DATADIR}/sonarcal COMPONENT program)

# The pages with their pictures, in the folders that they have in the sources, so that links between them hold.
set(SONARCAL_PAGES ${PROJECT_BINARY_DIR}/pages)
find_package(Python REQUIRED COMPONENTS Interpreter)
file(GLOB_RECURSE pages CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/docs/*)
# Pages outside docs/ to which pages of docs/ lead.
set(other_pages README.md CHANGELOG.md THIRD_PARTY_NOTICES.md data_io/README.md notebooks/README.md)
list(TRANSFORM other_pages PREPEND ${PROJECT_SOURCE_DIR}/ OUTPUT_VARIABLE other_page_files)
add_custom_command(OUTPUT ${SONARCAL_PAGES}.done
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${SONARCAL_PAGES}
  COMMAND ${Python_EXECUTABLE} -I ${PROJECT_SOURCE_DIR}/cmake/install_pages.py ${PROJECT_SOURCE_DIR} ${SONARCAL_PAGES}
    ${other_pages}
  COMMAND ${CMAKE_COMMAND} -E touch ${SONARCAL_PAGES}.done
  DEPENDS ${pages} ${other_page_files} ${PROJECT_SOURCE_DIR}/cmake/install_pages.py
  VERBATIM)
add_custom_target(installed_pages ALL DEPENDS ${SONARCAL_PAGES}.done)
install(DIRECTORY ${SONARCAL_PAGES}/ DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)

find_program(SONARCAL_DOXYGEN doxygen)
if(SONARCAL_DOXYGEN)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/Doxyfile.in ${PROJECT_BINARY_DIR}/Doxyfile @ONLY)
  add_custom_target(docs
    COMMAND ${SONARCAL_DOXYGEN} ${PROJECT_BINARY_DIR}/Doxyfile
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    COMMENT "Writing the reference of the libraries to ${PROJECT_BINARY_DIR}/api"
    VERBATIM)
endif()

# The site shows the Python module if it is built already: a change of a page needs no compiler.
execute_process(COMMAND ${Python_EXECUTABLE} -c "import furo, myst_parser, sphinx"
  RESULT_VARIABLE site_packages_missing OUTPUT_QUIET ERROR_QUIET)
if(SONARCAL_DOXYGEN AND NOT site_packages_missing)
  set(SONARCAL_DOCS_SITE ${PROJECT_BINARY_DIR}/site)
  add_custom_target(docs_site
    COMMAND ${Python_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/cmake/docs_site/make_site.py ${PROJECT_SOURCE_DIR}
      ${PROJECT_VERSION} ${PROJECT_BINARY_DIR} ${PROJECT_BINARY_DIR}/python ${SONARCAL_DOCS_SITE}
    DEPENDS docs
    COMMENT "Writing the documentation site to ${SONARCAL_DOCS_SITE}"
    VERBATIM)
else()
  message(STATUS "The target docs_site needs the packages doxygen, python3-sphinx, python3-myst-parser and furo")
endif()

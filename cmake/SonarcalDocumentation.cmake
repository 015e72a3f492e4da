# Manual pages and shell completion, written by the program from its own commands, and the reference of the
# libraries (target `docs`, needs Doxygen).
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

# Manual pages and shell completion, written by the program from its own commands, and the reference of the
# libraries (target `docs`, needs Doxygen).
set(documentation_dir ${PROJECT_BINARY_DIR}/documentation)
add_custom_command(OUTPUT ${documentation_dir}/sonarcal.1
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${documentation_dir}
  COMMAND sonarcal documentation --quiet --out ${documentation_dir}
  DEPENDS sonarcal
  COMMENT "Writing manual pages and completion"
  VERBATIM)
add_custom_target(manual_pages ALL DEPENDS ${documentation_dir}/sonarcal.1)

install(DIRECTORY ${documentation_dir}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program
  FILES_MATCHING PATTERN "*.1")
install(FILES ${documentation_dir}/sonarcal.bash
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME sonarcal COMPONENT program)
install(FILES ${documentation_dir}/_sonarcal
  DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)
install(FILES ${documentation_dir}/sonarcal.fish
  DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/cases DESTINATION ${CMAKE_INSTALL_DATADIR}/sonarcal COMPONENT program)
install(PROGRAMS ${PROJECT_SOURCE_DIR}/apps/batch/dask_batch.py
  DESTINATION ${CMAKE_INSTALL_DATADIR}/sonarcal COMPONENT program)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program
  FILES_MATCHING PATTERN "*.md" PATTERN images EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright
  COMPONENT program)

find_program(SONARCAL_DOXYGEN doxygen)
if(SONARCAL_DOXYGEN)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/Doxyfile.in ${PROJECT_BINARY_DIR}/Doxyfile @ONLY)
  add_custom_target(docs
    COMMAND ${SONARCAL_DOXYGEN} ${PROJECT_BINARY_DIR}/Doxyfile
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    COMMENT "Writing the reference of the libraries to ${PROJECT_BINARY_DIR}/api"
    VERBATIM)
endif()

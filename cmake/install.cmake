# What `cmake --install` puts where: the command with its manual and shell completion, the libraries with their headers,
# and the CMake package.
include(CMakePackageConfigHelpers)
set(ARETE_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/arete)

install(TARGETS arete_tool RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS arete_core arete_gis EXPORT areteTargets)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/core ${PROJECT_SOURCE_DIR}/gis
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/arete FILES_MATCHING PATTERN "*.h" PATTERN gdal_errors.h EXCLUDE)

install(EXPORT areteTargets NAMESPACE arete:: DESTINATION ${ARETE_CMAKE_DIR})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/areteConfig.cmake.in ${PROJECT_BINARY_DIR}/areteConfig.cmake
  INSTALL_DESTINATION ${ARETE_CMAKE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/areteConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/areteConfig.cmake ${PROJECT_BINARY_DIR}/areteConfigVersion.cmake
  ${CMAKE_CURRENT_LIST_DIR}/FindFLANN.cmake DESTINATION ${ARETE_CMAKE_DIR})

install(DIRECTORY ${PROJECT_SOURCE_DIR}/dictionaries/ DESTINATION ${CMAKE_INSTALL_DATADIR}/arete/dictionaries)

# The command writes its own manual pages and completions, from the options that it has.
set(ARETE_DOC_DIR ${PROJECT_BINARY_DIR}/generated)
add_custom_command(OUTPUT ${ARETE_DOC_DIR}/stamp
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${ARETE_DOC_DIR}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${ARETE_DOC_DIR}/man1
  COMMAND arete_tool man --all ${ARETE_DOC_DIR}/man1
  COMMAND arete_tool completion bash > ${ARETE_DOC_DIR}/arete
  COMMAND arete_tool completion zsh > ${ARETE_DOC_DIR}/_arete
  COMMAND arete_tool completion fish > ${ARETE_DOC_DIR}/arete.fish
  COMMAND ${CMAKE_COMMAND} -E touch ${ARETE_DOC_DIR}/stamp
  DEPENDS arete_tool
  COMMENT "Writing the manual pages and shell completions" VERBATIM)
add_custom_target(arete_generated ALL DEPENDS ${ARETE_DOC_DIR}/stamp)
install(DIRECTORY ${ARETE_DOC_DIR}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR})
install(FILES ${ARETE_DOC_DIR}/arete DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${ARETE_DOC_DIR}/_arete DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
install(FILES ${ARETE_DOC_DIR}/arete.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)

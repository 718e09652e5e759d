# `cmake --install` and find_package(hearsay CONFIG).

include(CMakePackageConfigHelpers)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/hearsay)

install(DIRECTORY sim net filters agents scenarios tools
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/hearsay FILES_MATCHING PATTERN "*.hpp"
  PATTERN figures EXCLUDE PATTERN bench EXCLUDE)
install(DIRECTORY scenarios DESTINATION ${CMAKE_INSTALL_DATADIR}/hearsay
  FILES_MATCHING PATTERN "*.toml" REGEX "/plans/[^/]*[.]txt$")
install(DIRECTORY tools/figures DESTINATION ${CMAKE_INSTALL_DATADIR}/hearsay/tools
  FILES_MATCHING PATTERN "*.py")
install(EXPORT hearsay NAMESPACE hearsay:: DESTINATION ${config_dir})
install(FILES cmake/Dependencies.cmake DESTINATION ${config_dir}
  RENAME hearsay-dependencies.cmake)
file(WRITE ${PROJECT_BINARY_DIR}/hearsay-config.cmake
  "include(\${CMAKE_CURRENT_LIST_DIR}/hearsay-dependencies.cmake)\ninclude(\${CMAKE_CURRENT_LIST_DIR}/hearsay.cmake)\n")
write_basic_package_version_file(${PROJECT_BINARY_DIR}/hearsay-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/hearsay-config.cmake
  ${PROJECT_BINARY_DIR}/hearsay-config-version.cmake DESTINATION ${config_dir})

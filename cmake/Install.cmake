# `cmake --install` and find_package(hearsay CONFIG).

include(CMakePackageConfigHelpers)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/hearsay)

install(DIRECTORY sim net filters agents scenarios tools
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/hearsay FILES_MATCHING PATTERN "*.hpp"
  PATTERN figures EXCLUDE PATTERN bench EXCLUDE
  PATTERN raw_type.hpp EXCLUDE PATTERN descriptors.hpp EXCLUDE PATTERN cdr_fields.hpp EXCLUDE)
install(DIRECTORY scenarios DESTINATION ${CMAKE_INSTALL_DATADIR}/hearsay
  FILES_MATCHING PATTERN "*.toml" REGEX "/plans/[^/]*[.]txt$")
install(DIRECTORY tools/figures DESTINATION ${CMAKE_INSTALL_DATADIR}/hearsay/tools
  FILES_MATCHING PATTERN "*.py")
install(EXPORT hearsay NAMESPACE hearsay:: DESTINATION ${config_dir})
install(FILES cmake/Dependencies.cmake DESTINATION ${config_dir}
  RENAME hearsay-dependencies.cmake)
if(HEARSAY_LIVE)
  install(EXPORT hearsay-idl NAMESPACE hearsay:: DESTINATION ${config_dir})
endif()
file(RELATIVE_PATH hearsay_config_to_prefix ${CMAKE_INSTALL_PREFIX}/${config_dir} ${CMAKE_INSTALL_PREFIX})
configure_file(cmake/hearsay-config.cmake.in ${PROJECT_BINARY_DIR}/hearsay-config.cmake @ONLY)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/hearsay-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/hearsay-config.cmake
  ${PROJECT_BINARY_DIR}/hearsay-config-version.cmake DESTINATION ${config_dir})

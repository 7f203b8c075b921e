# What `cmake --install` puts where, and the package that find_package(vecino) finds there.

include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/vecino)
set(data_dir ${CMAKE_INSTALL_DATADIR}/vecino)
set(program_dir ${CMAKE_INSTALL_BINDIR})

install(TARGETS vecino)
install(TARGETS vecino_core vecino_filters EXPORT vecino_targets
    FILE_SET HEADERS DESTINATION ${VECINO_INSTALL_INCLUDEDIR})
install(EXPORT vecino_targets FILE vecino-targets.cmake NAMESPACE vecino:: DESTINATION ${package_dir})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY configs scenes DESTINATION ${data_dir} FILES_MATCHING PATTERN *.json PATTERN *.png)

string(REGEX MATCH "^[0-9]+" embree_major "${embree_VERSION}")
set(made_dir ${PROJECT_BINARY_DIR}/package)
configure_package_config_file(core/vecino-config.cmake.in ${made_dir}/vecino-config.cmake
    INSTALL_DESTINATION ${package_dir} PATH_VARS data_dir program_dir NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file(${made_dir}/vecino-config-version.cmake
    COMPATIBILITY SameMinorVersion)  # while the major version is 0
install(FILES ${made_dir}/vecino-config.cmake ${made_dir}/vecino-config-version.cmake
    eval/vecino-image-test.cmake eval/vecino-run-image-test.cmake
    DESTINATION ${package_dir})

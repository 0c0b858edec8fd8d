# `cmake --install BUILD --component core`: for find_package(dampline) and pkg-config. Only the
# headers directly in dampline/ are the interface; those below them are what they include.
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/dampline)
install(TARGETS dampline_core EXPORT dampline COMPONENT core ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY dampline DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT core
        FILES_MATCHING PATTERN *.hpp PATTERN *.h)
install(EXPORT dampline NAMESPACE dampline:: FILE dampline-targets.cmake
        DESTINATION ${package_folder} COMPONENT core)
configure_package_config_file(cmake/dampline-config.cmake.in dampline-config.cmake
                              INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(dampline-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/dampline-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/dampline-config-version.cmake
        DESTINATION ${package_folder} COMPONENT core)

# One for programs in C++, which compile the core's headers, and one for programs in C, which link it.
file(RELATIVE_PATH prefix_from_pc "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
function(pkg_config name description requires flags)
  configure_file(cmake/dampline.pc.in ${name}.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT core)
endfunction()
pkg_config(dampline "damping of a freight-car truck, from accelerations in service (C++20)"
           "Requires: eigen3 >= 3.4" "-std=c++20 -ffp-contract=off -DEIGEN_DONT_VECTORIZE")
pkg_config(dampline-c "damping of a freight-car truck, from accelerations in service (C)" "" "")

# What `cmake --install` puts where: component `runtime` is the command, `development` the library.
include(CMakePackageConfigHelpers)

# mica_install_library(TARGET COMPONENT [EXCLUDE_FROM_ALL]): headers, library, CMake package and pkg-config file.
function(mica_install_library target component)
  set(package ${CMAKE_INSTALL_LIBDIR}/cmake/mica)
  set(made ${PROJECT_BINARY_DIR}/packaging/${target})
  get_target_property(MICA_LIBRARY_TYPE ${target} TYPE)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/packaging/mica-config.cmake.in ${made}/mica-config.cmake
                                INSTALL_DESTINATION ${package})
  write_basic_package_version_file(${made}/mica-config-version.cmake COMPATIBILITY SameMinorVersion)
  file(RELATIVE_PATH MICA_PREFIX_FROM_PC /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  string(REGEX REPLACE "/$" "" MICA_PREFIX_FROM_PC ${MICA_PREFIX_FROM_PC})
  if(MICA_LIBRARY_TYPE STREQUAL STATIC_LIBRARY)
    set(MICA_PC_REQUIRES " fmt spdlog tbb tomlplusplus OpenCL libxxhash OpenImageIO")
    set(MICA_PC_LIBRARIES " -lembree3 -pthread")
  else()
    set(MICA_PC_FLAGS " -DMICA_SHARED")
  endif()
  configure_file(${PROJECT_SOURCE_DIR}/packaging/mica.pc.in ${made}/mica.pc @ONLY)

  set(where COMPONENT ${component} ${ARGN})
  install(
    TARGETS ${target}
    EXPORT ${target}-targets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} ${where}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} ${where})
  install(EXPORT ${target}-targets FILE mica-targets.cmake NAMESPACE mica:: DESTINATION ${package} ${where})
  install(FILES ${made}/mica-config.cmake ${made}/mica-config-version.cmake DESTINATION ${package} ${where})
  install(FILES ${made}/mica.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig ${where})
  install(
    DIRECTORY ${PROJECT_SOURCE_DIR}/include/mica
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} ${where}
    FILES_MATCHING PATTERN *.h)
endfunction()

# The manual page and the completions, told by the command itself.
set(MICA_ZSH_DIRECTORY ${CMAKE_INSTALL_DATADIR}/zsh/site-functions CACHE STRING "Where zsh looks for completions")
set(manual ${PROJECT_BINARY_DIR}/manual)
add_custom_command(
  OUTPUT ${manual}/mica.1.gz ${manual}/mica ${manual}/_mica ${manual}/mica.fish
  COMMAND ${CMAKE_COMMAND} -E make_directory ${manual}
  COMMAND mica_command manual man > ${manual}/mica.1
  COMMAND gzip --best --no-name --force ${manual}/mica.1
  COMMAND mica_command manual bash > ${manual}/mica
  COMMAND mica_command manual zsh > ${manual}/_mica
  COMMAND mica_command manual fish > ${manual}/mica.fish
  DEPENDS mica_command
  COMMENT "Writing the manual page and the shells' completions")
add_custom_target(mica_manual ALL DEPENDS ${manual}/mica.1.gz)

install(TARGETS mica_command DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
install(FILES ${manual}/mica.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)
install(FILES ${manual}/mica DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT runtime)
install(FILES ${manual}/_mica DESTINATION ${MICA_ZSH_DIRECTORY} COMPONENT runtime)
install(FILES ${manual}/mica.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT runtime)
install(FILES README.md CHANGELOG.md SECURITY.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime FILES_MATCHING PATTERN *.md
        PATTERN images EXCLUDE)
if(NOT MICA_DEBIAN)  # whose policy has a file `copyright` in its place
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
endif()
mica_install_library(mica_public development)

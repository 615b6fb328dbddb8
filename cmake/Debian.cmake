# Debian packages: `mica` is the command, `libmica-dev` what programs are built with. The preset `package` configures
# for them, scripts/package makes them.
set(MICA_CONTACT "Mica maintainers <maintainers@mica.invalid>" CACHE STRING "Maintainer of the Debian packages")

# When this version was made: the same packages from the same commit.
set(date "Thu, 01 Jan 1970 00:00:00 +0000")
if(GIT_FOUND AND EXISTS ${PROJECT_SOURCE_DIR}/.git)
  execute_process(
    COMMAND ${GIT_EXECUTABLE} log -1 --format=%cD
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
set(MICA_DATE ${date})
string(REGEX MATCH "[0-9][0-9][0-9][0-9]" MICA_YEAR ${date})

# What policy asks of every package: its changelog and its licence.
foreach(package mica libmica-dev)
  set(made ${PROJECT_BINARY_DIR}/packaging/${package})
  configure_file(packaging/changelog.in ${made}/changelog @ONLY)
  configure_file(packaging/copyright.in ${made}/copyright @ONLY)
  execute_process(COMMAND gzip --best --no-name --force ${made}/changelog)
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/packaging/mica/changelog.gz ${PROJECT_BINARY_DIR}/packaging/mica/copyright
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/mica COMPONENT runtime)
install(FILES ${PROJECT_BINARY_DIR}/packaging/libmica-dev/changelog.gz
              ${PROJECT_BINARY_DIR}/packaging/libmica-dev/copyright
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libmica-dev COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each component has its own, as the first line of its description
set(CPACK_PACKAGE_CONTACT ${MICA_CONTACT})
set(CPACK_PACKAGE_VENDOR Mica)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL runtime development)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
                                                WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME mica)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS "pocl-opencl-icd | opencl-icd")
set(CPACK_DEBIAN_RUNTIME_DESCRIPTION
    "glint normal distribution functions on OpenCL
Computes the distribution of normals inside each pixel's footprint on a
surface with an explicit normal map, in large batches on OpenCL devices:
pictures with glints that stay coherent, tables for other renderers, and a
double-precision reference that says how far off they are.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libmica-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
# What a program that uses the static library is linked with, of what scripts/install lists.
set(link_packages libopenimageio-dev libembree-dev libtbb-dev libtomlplusplus-dev libfmt-dev libspdlog-dev libxxhash-dev
                  ocl-icd-opencl-dev pkg-config)
list(JOIN link_packages ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "pocl-opencl-icd | opencl-icd")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION
    "glint normal distribution functions on OpenCL (development)
The library behind the command mica: headers, static library, CMake package
and pkg-config file.")
include(CPack)

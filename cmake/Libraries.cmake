# What Mica is built on, and the flags of its own sources.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(TBB REQUIRED)
find_package(embree 3 REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(OpenCL REQUIRED)
find_package(Boost REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(mica_xxhash REQUIRED IMPORTED_TARGET libxxhash)
# Debian's CMake package of OpenImageIO insists on the command line tools; pkg-config does not.
pkg_check_modules(mica_OpenImageIO REQUIRED IMPORTED_TARGET OpenImageIO)

# What programs that use libmica.a are linked with: packaging/mica-config.cmake.in finds the same ones again.
set(MICA_LINKED_LIBRARIES Threads::Threads fmt::fmt spdlog::spdlog TBB::tbb embree OpenCL::OpenCL
                          tomlplusplus::tomlplusplus PkgConfig::mica_xxhash PkgConfig::mica_OpenImageIO)
add_library(mica_libraries INTERFACE)
target_link_libraries(
  mica_libraries INTERFACE ${MICA_LINKED_LIBRARIES} Eigen3::Eigen CLI11::CLI11 nlohmann_json::nlohmann_json
                           Boost::headers)

# Warnings and sanitizers, for every target of this project.
add_library(mica_options INTERFACE)
target_compile_options(mica_options INTERFACE -Wall -Wextra)
if(MICA_DEVELOPER)
  target_compile_options(mica_options INTERFACE -Werror)
endif()
target_include_directories(mica_options INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/include
                                                  ${PROJECT_SOURCE_DIR}/kernels)
target_compile_definitions(mica_options INTERFACE MICA_SHARED MICA_VERSION="${PROJECT_VERSION}")
if(MICA_SANITIZE)
  # Without the checks of pointers that take a third of a unit's compilation and that the address sanitizer stops at,
  # too, when the memory is not there. With sanitizers gcc takes the empty side of an optional for a number that is read
  # before it is set.
  target_compile_options(mica_options INTERFACE -fsanitize=address,undefined
                                                -fno-sanitize=null,alignment,object-size,vptr
                                                -fno-sanitize-recover=all -fno-omit-frame-pointer -Wno-maybe-uninitialized)
  target_link_options(mica_options INTERFACE -fsanitize=address,undefined)
endif()

# libmica, as others link it. All that is not MICA_API of include/mica is hidden in the objects already.

# mica_library(TARGET [STATIC|SHARED]): without a type, BUILD_SHARED_LIBS chooses.
function(mica_library target)
  add_library(${target} ${ARGN})
  mica_collect(${target})
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${target} PUBLIC cxx_std_17)
  target_link_libraries(${target} PRIVATE ${MICA_LINKED_LIBRARIES})
  set(abi ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME mica EXPORT_NAME mica LINKER_LANGUAGE CXX
                                             VERSION ${PROJECT_VERSION} SOVERSION ${abi})
  get_target_property(type ${target} TYPE)
  if(type STREQUAL SHARED_LIBRARY)
    target_compile_definitions(${target} PUBLIC MICA_SHARED)
    # Weak symbols of the C++ library's templates are visible whatever the compiler is told.
    set(MICA_ABI v${PROJECT_VERSION_MAJOR}_${PROJECT_VERSION_MINOR})
    set(symbols ${PROJECT_BINARY_DIR}/mica.symbols)
    configure_file(${PROJECT_SOURCE_DIR}/packaging/mica.symbols.in ${symbols} @ONLY)
    target_link_options(${target} PRIVATE -Wl,--version-script=${symbols} -Wl,-z,defs)
    set_target_properties(${target} PROPERTIES LINK_DEPENDS ${symbols})
  endif()
endfunction()

mica_library(mica_public)
add_library(mica::mica ALIAS mica_public)

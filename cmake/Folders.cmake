# A folder of host/ is a target, compiled in one or a few pieces: most of a file's compile time is the headers that
# its neighbours include as well.

# mica_headers(TARGET KIND HEADER...): the headers of other people, parsed once for all targets of a kind. The first one
# keeps them. Targets of a kind have the same flags: objects are position independent otherwise than programs are.
function(mica_headers target kind)
  get_property(first GLOBAL PROPERTY MICA_HEADERS_OF_${kind})
  if(first)
    target_precompile_headers(${target} REUSE_FROM ${first})
  else()
    target_precompile_headers(${target} PRIVATE ${ARGN})
    set_property(GLOBAL PROPERTY MICA_HEADERS_OF_${kind} ${target})
  endif()
endfunction()

# mica_folder(FOLDER): host/FOLDER/*.cpp as objects, which mica_collect gives to a library.
function(mica_folder folder)
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/host/${folder}/*.cpp)
  if(NOT sources)
    return()
  endif()
  string(REPLACE / _ name mica_${folder})
  add_library(${name} OBJECT ${sources})
  set(batch 12)
  if(folder MATCHES "^methods")
    set(batch 6)  # who edits a method waits for its unit
  endif()
  set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${batch})
  # Types of an unnamed namespace have their linkage in the file that a unit includes as well as in the unit.
  target_compile_options(${name} PRIVATE -Wno-subobject-linkage)
  target_link_libraries(${name} PRIVATE mica_options mica_libraries)
  set_property(GLOBAL APPEND PROPERTY MICA_FOLDERS ${name})
  mica_headers(${name} OBJECTS ${PROJECT_SOURCE_DIR}/cmake/headers.h)
  mica_note_units(${name} ${batch} ${sources})
endfunction()

# Where CMake writes the units of `target`, for the lint: MICA_UNITS, and MICA_SOURCES_<unit> of each.
function(mica_note_units target batch)
  set(together)
  foreach(source ${ARGN})
    get_source_file_property(apart ${source} SKIP_UNITY_BUILD_INCLUSION)
    if(apart)
      set_property(GLOBAL APPEND PROPERTY MICA_UNITS ${source})
    else()
      list(APPEND together ${source})
    endif()
  endforeach()
  list(LENGTH together count)
  math(EXPR last "(${count} - 1) / ${batch}")
  foreach(n RANGE ${last})
    math(EXPR first "${n} * ${batch}")
    list(SUBLIST together ${first} ${batch} sources)
    set(unit ${PROJECT_BINARY_DIR}/CMakeFiles/${target}.dir/Unity/unity_${n}_cxx.cxx)
    set_property(GLOBAL APPEND PROPERTY MICA_UNITS ${unit})
    set_property(GLOBAL PROPERTY MICA_SOURCES_${unit} ${sources})
  endforeach()
endfunction()

function(mica_collect library)
  get_property(folders GLOBAL PROPERTY MICA_FOLDERS)
  foreach(folder ${folders})
    target_sources(${library} PRIVATE $<TARGET_OBJECTS:${folder}>)
  endforeach()
endfunction()

# The text of every kernel, as a source of `target`.
function(mica_embed_kernels target)
  file(GLOB_RECURSE kernels CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/kernels/*.cl ${PROJECT_SOURCE_DIR}/kernels/*.h)
  set(output ${PROJECT_BINARY_DIR}/kernel_sources.cpp)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DKERNELS=${PROJECT_SOURCE_DIR}/kernels -DOUTPUT=${output} -P
            ${PROJECT_SOURCE_DIR}/cmake/EmbedKernels.cmake
    DEPENDS ${kernels} ${PROJECT_SOURCE_DIR}/cmake/EmbedKernels.cmake
    COMMENT "Embedding kernels")
  target_sources(${target} PRIVATE ${output})
  set_source_files_properties(${output} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON)
endfunction()

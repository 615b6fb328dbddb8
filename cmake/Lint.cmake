# What the compiler of the host does not say: kernels as strict OpenCL C 1.2 by clang, layout by clang-format, habits
# by clang-tidy. Checks leave stamps, so that only what changed is looked at again. `lint` runs them all, and each of
# lint_kernels, lint_format and lint_tidy is a test as well.
if(MICA_SANITIZE)
  return()  # the other build looks at the same sources
endif()

find_program(CLANG clang-14 REQUIRED)
find_program(CLANG_FORMAT clang-format-14 REQUIRED)
find_program(CLANG_TIDY clang-tidy-14 REQUIRED)
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/lint)
add_custom_target(lint)

function(lint_target name)
  add_custom_target(${name} DEPENDS ${ARGN})
  add_dependencies(lint ${name})
  add_test(NAME ${name} COMMAND ${CMAKE_COMMAND} --build ${CMAKE_BINARY_DIR} --target ${name})
  # One Ninja at a time in a build folder; it keeps all processors busy by itself.
  set_tests_properties(${name} PROPERTIES RUN_SERIAL TRUE)
endfunction()

# Each kernel file in every variant that the host may ask for, and each header alone in both forms of a wave.
set(kernels ${CMAKE_SOURCE_DIR}/kernels)
file(GLOB_RECURSE kernel_programs CONFIGURE_DEPENDS ${kernels}/*.cl)
file(GLOB_RECURSE kernel_headers CONFIGURE_DEPENDS ${kernels}/*.h)
set(parts map/catmull_rom.h map/texel_quads.h map/walk_leaves.h pyramid/turned_elements.h pyramid/walk_records.h
    smooth/turned_slopes.h wave/primitives.h)  # of what includes them
set(of_first_order gaussians/gaussians.cl grid/grid.cl pyramid/pyramid.cl smooth/smooth.cl triangles/triangles.cl)  # a variant
set(of_records images/pyramid_images.cl pyramid/pyramid.cl)  # whose width is a variant
set(compile_kernel ${CLANG} -x cl -cl-std=CL1.2 -fsyntax-only -Wall -Wextra -Werror -I ${kernels})
set(kernel_stamps)
foreach(file ${kernel_programs} ${kernel_headers})
  file(RELATIVE_PATH name ${kernels} ${file})
  if(name IN_LIST parts)
    continue()
  endif()
  set(commands)
  foreach(wave_items 0 1)
    if(name MATCHES "\\.h$")
      list(APPEND commands COMMAND ${compile_kernel} -DMICA_WAVE_ITEMS=${wave_items} -include ${file} /dev/null)
    else()
      # What processors with AVX2 alone run; with all else it is as it is without.
      if(NOT wave_items)
        list(APPEND commands COMMAND ${compile_kernel} -mavx2 -mfma -mbmi2 ${file})
        list(APPEND commands COMMAND ${compile_kernel} -DMICA_NATIVE=1 ${file})
      endif()
      foreach(interpolation 0 1 2)
        list(APPEND commands COMMAND ${compile_kernel} -DMICA_WAVE_ITEMS=${wave_items}
                                     -DMICA_INTERPOLATION=${interpolation} ${file})
      endforeach()
      if(name IN_LIST of_first_order)
        foreach(interpolation 0 1 2)
          list(APPEND commands COMMAND ${compile_kernel} -DMICA_WAVE_ITEMS=${wave_items} -DMICA_FIRST_ORDER=1
                                       -DMICA_INTERPOLATION=${interpolation} ${file})
        endforeach()
      endif()
      if(name STREQUAL triangles/triangles.cl)
        foreach(precision 1 2)
          list(APPEND commands COMMAND ${compile_kernel} -DMICA_WAVE_ITEMS=${wave_items} -DMICA_PRECISION=${precision}
                                       ${file})
        endforeach()
      endif()
      if(name IN_LIST of_records)
        list(APPEND commands COMMAND ${compile_kernel} -DMICA_WAVE_ITEMS=${wave_items} -DMICA_RECORD_BITS=8 ${file})
      endif()
    endif()
  endforeach()
  string(REPLACE / - stamp ${name})
  set(stamp ${CMAKE_BINARY_DIR}/lint/${stamp}.kernel)
  add_custom_command(
    OUTPUT ${stamp} ${commands}
    COMMAND ${CMAKE_COMMAND} -E touch ${stamp}
    DEPENDS ${file} ${kernel_headers}
    COMMENT "Compiling ${name} as OpenCL C 1.2")
  list(APPEND kernel_stamps ${stamp})
endforeach()
lint_target(lint_kernels ${kernel_stamps})

set(formatted)
foreach(folder host include kernels samples tests bench tools python)
  foreach(ending cpp h cl)
    file(GLOB_RECURSE files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${folder}/*.${ending})
    list(APPEND formatted ${files})
  endforeach()
endforeach()
set(format_stamp ${CMAKE_BINARY_DIR}/lint/format)
add_custom_command(
  OUTPUT ${format_stamp}
  COMMAND ${CLANG_FORMAT} --dry-run -Werror ${formatted}
  COMMAND ${CMAKE_COMMAND} -E touch ${format_stamp}
  DEPENDS ${formatted} ${CMAKE_SOURCE_DIR}/.clang-format
  COMMENT "Checking the layout of sources")
lint_target(lint_format ${format_stamp})

# clang-tidy looks at the units that are compiled: most of its time goes into the headers that their sources share. It
# cannot read the other compiler's precompiled ones, so its commands are without.
set(tidy_commands ${CMAKE_BINARY_DIR}/lint/compile_commands.json)
add_custom_command(
  OUTPUT ${tidy_commands}
  COMMAND sed "s/ -Winvalid-pch -include [^ ]*//" ${CMAKE_BINARY_DIR}/compile_commands.json > ${tidy_commands}
  DEPENDS ${CMAKE_BINARY_DIR}/compile_commands.json)
file(GLOB_RECURSE cpp_headers CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/host/*.h ${CMAKE_SOURCE_DIR}/include/*.h)
get_property(units GLOBAL PROPERTY MICA_UNITS)
set(tidy_stamps)
foreach(unit ${units})
  get_property(sources GLOBAL PROPERTY MICA_SOURCES_${unit})
  string(REGEX REPLACE "^.*/(CMakeFiles|host)/" "" name ${unit})
  string(REGEX REPLACE "\\.dir/Unity/|/" "-" name ${name})
  set(stamp ${CMAKE_BINARY_DIR}/lint/${name}.tidy)
  add_custom_command(
    OUTPUT ${stamp}
    COMMAND ${CLANG_TIDY} --quiet --config-file=${CMAKE_SOURCE_DIR}/.clang-tidy -p ${CMAKE_BINARY_DIR}/lint
            --extra-arg=-Wno-unknown-warning-option ${unit}
    COMMAND ${CMAKE_COMMAND} -E touch ${stamp}
    DEPENDS ${unit} ${sources} ${cpp_headers} ${CMAKE_SOURCE_DIR}/.clang-tidy ${kernels}/types.h ${tidy_commands}
    COMMENT "Checking ${name} with clang-tidy")
  list(APPEND tidy_stamps ${stamp})
endforeach()
lint_target(lint_tidy ${tidy_stamps})

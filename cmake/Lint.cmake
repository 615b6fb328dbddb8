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
file(GLOB_RECURSE kernel_programs CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/kernels/*.cl)
file(GLOB_RECURSE kernel_headers CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/kernels/*.h)
set(compile_kernel ${CLANG} -x cl -cl-std=CL1.2 -fsyntax-only -Wall -Wextra -Werror -Xclang -finclude-default-header
                   -I ${CMAKE_SOURCE_DIR}/kernels)
set(kernel_stamps)
foreach(file ${kernel_programs} ${kernel_headers})
  get_filename_component(name ${file} NAME)
  if(name MATCHES "^(catmull_rom|texel_quads|turned_elements|turned_slopes|walk_leaves|walk_records)\\.h$")
    continue()  # parts of the kernels that include them, whose types they use
  endif()
  set(commands)
  foreach(wave_items 0 1)
    if(name MATCHES "\\.h$")
      list(APPEND commands COMMAND ${compile_kernel} -DMICA_WAVE_ITEMS=${wave_items} -include ${file} /dev/null)
    else()
      foreach(interpolation 0 1 2)
        list(APPEND commands COMMAND ${compile_kernel} -DMICA_WAVE_ITEMS=${wave_items}
                                     -DMICA_INTERPOLATION=${interpolation} ${file})
      endforeach()
      if(name MATCHES "^(triangles|gaussians|smooth|pyramid)\\.cl$")
        foreach(interpolation 0 1 2)
          list(APPEND commands COMMAND ${compile_kernel} -DMICA_WAVE_ITEMS=${wave_items} -DMICA_FIRST_ORDER=1
                                       -DMICA_INTERPOLATION=${interpolation} ${file})
        endforeach()
      endif()
      if(name MATCHES "^pyramid")
        list(APPEND commands COMMAND ${compile_kernel} -DMICA_WAVE_ITEMS=${wave_items} -DMICA_RECORD_BITS=8 ${file})
      endif()
    endif()
  endforeach()
  set(stamp ${CMAKE_BINARY_DIR}/lint/${name}.kernel)
  add_custom_command(
    OUTPUT ${stamp} ${commands}
    COMMAND ${CMAKE_COMMAND} -E touch ${stamp}
    DEPENDS ${file} ${kernel_headers}
    COMMENT "Compiling ${name} as OpenCL C 1.2")
  list(APPEND kernel_stamps ${stamp})
endforeach()
lint_target(lint_kernels ${kernel_stamps})

file(GLOB_RECURSE cpp_sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/host/*.cpp)
file(GLOB_RECURSE cpp_headers CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/host/*.h)
file(GLOB_RECURSE cpp_others CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/tests/*.cpp ${CMAKE_SOURCE_DIR}/tests/*.h
     ${CMAKE_SOURCE_DIR}/bench/*.cpp ${CMAKE_SOURCE_DIR}/bench/*.h ${CMAKE_SOURCE_DIR}/tools/*.cpp)

set(format_stamp ${CMAKE_BINARY_DIR}/lint/format)
add_custom_command(
  OUTPUT ${format_stamp}
  COMMAND ${CLANG_FORMAT} --dry-run -Werror ${cpp_sources} ${cpp_headers} ${cpp_others}
  COMMAND ${CMAKE_COMMAND} -E touch ${format_stamp}
  DEPENDS ${cpp_sources} ${cpp_headers} ${cpp_others} ${CMAKE_SOURCE_DIR}/.clang-format
  COMMENT "Checking the layout of sources")
lint_target(lint_format ${format_stamp})

set(tidy_stamps)
foreach(file ${cpp_sources})
  file(RELATIVE_PATH name ${CMAKE_SOURCE_DIR}/host ${file})
  string(REPLACE / - name ${name})
  set(stamp ${CMAKE_BINARY_DIR}/lint/${name}.tidy)
  add_custom_command(
    OUTPUT ${stamp}
    COMMAND ${CLANG_TIDY} --quiet -p ${CMAKE_BINARY_DIR} ${file}
    COMMAND ${CMAKE_COMMAND} -E touch ${stamp}
    DEPENDS ${file} ${cpp_headers} ${CMAKE_SOURCE_DIR}/.clang-tidy ${CMAKE_SOURCE_DIR}/kernels/types.h
    COMMENT "Checking ${name} with clang-tidy")
  list(APPEND tidy_stamps ${stamp})
endforeach()
lint_target(lint_tidy ${tidy_stamps})

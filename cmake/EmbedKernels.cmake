# Writes OUTPUT: a C++ source with the text of every file of kernels/, found by its path there at run time.
#   cmake -DKERNELS=dir -DOUTPUT=file.cpp -P EmbedKernels.cmake
file(GLOB_RECURSE files ${KERNELS}/*.cl ${KERNELS}/*.h)
list(SORT files)
set(text "// Generated from kernels/ by cmake/EmbedKernels.cmake.\n#include \"host/device/kernel_sources.h\"\n\n")
string(APPEND text "namespace mica::host {\n\nconst std::map<std::string, std::string>& kernel_sources() {\n")
string(APPEND text "  static const std::map<std::string, std::string> sources = {\n")
foreach(file ${files})
  file(RELATIVE_PATH name ${KERNELS} ${file})
  file(READ ${file} content)
  string(APPEND text "      {\"${name}\", R\"kernel(${content})kernel\"},\n")
endforeach()
string(APPEND text "  };\n  return sources;\n}\n\n}  // namespace mica::host\n")
file(WRITE ${OUTPUT} "${text}")

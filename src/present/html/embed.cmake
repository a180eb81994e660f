# Writes the files INPUTS (NAME=PATH;...) as C++ string constants into OUTPUT.
set(text "#pragma once\n#include <string_view>\nnamespace vpr::html {\n")
foreach(input ${INPUTS})
  string(REGEX REPLACE "=.*" "" name "${input}")
  string(REGEX REPLACE "^[^=]*=" "" path "${input}")
  file(READ "${path}" content)
  string(APPEND text "inline constexpr std::string_view ${name} = R\"embedded(${content})embedded\";\n")
endforeach()
file(WRITE "${OUTPUT}" "${text}}  // namespace vpr::html\n")

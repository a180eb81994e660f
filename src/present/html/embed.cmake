# Writes the files INPUTS (NAME=PATH;...) as C++ string constants into OUTPUT.
set(text "")
foreach(input ${INPUTS})
  string(REGEX REPLACE "=.*" "" name "${input}")
  string(REGEX REPLACE "^[^=]*=" "" path "${input}")
  file(READ "${path}" content)
  string(APPEND text "constexpr std::string_view ${name} = R\"embedded(${content})embedded\";\n")
endforeach()
file(WRITE "${OUTPUT}" "${text}")

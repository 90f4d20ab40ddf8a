# cmake -DOUT=FILE -DFOLDER=config/farm -DNAMES=LIST -P embed.cmake: writes the files of `orchard farm
# init` as a C++ source. Names are relative to FOLDER; all but farm.yaml and the Snakefile go below
# profiles/.
cmake_minimum_required(VERSION 3.22)
set(entries "")
set(num 0)
foreach(name IN LISTS NAMES)
  file(READ ${FOLDER}/${name} text)
  if(name MATCHES "/")
    set(place "profiles/${name}")
  else()
    set(place "${name}")
  endif()
  string(APPEND entries "    {\"${place}\", R\"orchard(${text})orchard\"},\n")
  math(EXPR num "${num} + 1")
endforeach()
file(WRITE ${OUT} "// Made by procs/cli/farm/embed.cmake.\n#include \"cli/farm/farm.hpp\"\n
namespace orchard::cli {
const ShippedFile kFarmFiles[] = {\n${entries}};
const int kNumFarmFiles = ${num};
}  // namespace orchard::cli\n")

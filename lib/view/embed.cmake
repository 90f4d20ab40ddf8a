# cmake -DOUT=FILE -DWEB=FOLDER -DSCRIPTS=LIST -P embed.cmake: the files of the page as a C++ source,
# and the hashes of script and style for the content security policy.
cmake_minimum_required(VERSION 3.22)
set(script "(() => {\n\"use strict\";\n")
foreach(name IN LISTS SCRIPTS)
  file(READ ${WEB}/${name} text)
  string(APPEND script "${text}\n")
endforeach()
string(APPEND script "})();\n")
file(READ ${WEB}/style.css style)
file(READ ${WEB}/page.html page)
foreach(text IN ITEMS "${script}" "${style}")
  if(text MATCHES "</script|</style|\\{\\{")
    message(FATAL_ERROR "a script or style of the page holds what would end it")
  endif()
endforeach()

# base64_of_sha256(TEXT OUT)
function(base64_of_sha256 text out)
  set(digits "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/")
  string(SHA256 hex "${text}")
  set(result "")
  foreach(group RANGE 0 10)
    math(EXPR begin "${group} * 6")
    string(SUBSTRING "${hex}0000" ${begin} 6 bytes)
    math(EXPR value "0x${bytes}")
    foreach(shift IN ITEMS 18 12 6 0)
      math(EXPR digit "(${value} >> ${shift}) & 63")
      string(SUBSTRING "${digits}" ${digit} 1 character)
      string(APPEND result "${character}")
    endforeach()
  endforeach()
  string(SUBSTRING "${result}" 0 43 result)  # 32 bytes: the last of the 44 digits is padding
  set(${out} "${result}=" PARENT_SCOPE)
endfunction()
base64_of_sha256("${script}" script_sum)
base64_of_sha256("${style}" style_sum)

file(WRITE ${OUT} "// Made by lib/view/embed.cmake.\n#include \"view/page_parts.hpp\"\n
namespace orchard::view {
const std::string_view kPage = R\"orchard(${page})orchard\";
const std::string_view kStyle = R\"orchard(${style})orchard\";
const std::string_view kScript = R\"orchard(${script})orchard\";
const std::string_view kStyleSum = \"sha256-${style_sum}\";
const std::string_view kScriptSum = \"sha256-${script_sum}\";
}  // namespace orchard::view\n")

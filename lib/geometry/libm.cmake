# The system's libm chooses other instructions on other processors, whose results differ in the last
# digit, and a map must not depend on the processor. So the elementary functions are musl's, which
# have one version. Linked into a program as an object, they are what its shared libraries call, too.
string(REPLACE gnu musl musl_architecture "${CMAKE_LIBRARY_ARCHITECTURE}")
find_file(ORCHARD_MUSL_LIBC libc.a NO_DEFAULT_PATH
          PATHS /usr/lib/${musl_architecture} /usr/${CMAKE_SYSTEM_PROCESSOR}-linux-musl/lib64 /usr/lib/musl/lib
          DOC "musl's static library of C, for functions that are equal on all processors")
if(NOT ORCHARD_MUSL_LIBC)
  message(WARNING "No libc.a of musl (package musl-dev): maps may differ in the last digits between processors.")
  return()
endif()
set(functions)
foreach(name acos asin atan atan2 cos exp exp2 log log10 log2 pow sin sincos tan)
  list(APPEND functions ${name} ${name}f)
endforeach()
list(APPEND functions cosh expm1 log1p sinh tanh)
# What these stand on, within musl.
list(APPEND functions __cos __cosdf __expo2 __rem_pio2 __rem_pio2_large __rem_pio2f __sin __sindf __tan __tandf exp_data
     exp2f_data log_data logf_data log2_data log2f_data pow_data powf_data)
foreach(case divzero invalid oflow uflow xflow)
  list(APPEND functions __math_${case} __math_${case}f)
endforeach()
list(TRANSFORM functions APPEND .lo)
set(folder ${CMAKE_CURRENT_BINARY_DIR}/libm)
set(ORCHARD_LIBM ${CMAKE_CURRENT_BINARY_DIR}/libm.o)
file(MAKE_DIRECTORY ${folder})
execute_process(COMMAND ${CMAKE_AR} x ${ORCHARD_MUSL_LIBC} ${functions} WORKING_DIRECTORY ${folder}
                RESULT_VARIABLE failed ERROR_VARIABLE why)
if(NOT failed)
  execute_process(COMMAND ${CMAKE_LINKER} -r -o ${ORCHARD_LIBM} ${functions} WORKING_DIRECTORY ${folder}
                  RESULT_VARIABLE failed ERROR_VARIABLE why)
endif()
if(failed)
  message(FATAL_ERROR "Cannot take the elementary functions from ${ORCHARD_MUSL_LIBC}: ${why}")
endif()
target_link_libraries(orchard_geometry PUBLIC $<BUILD_INTERFACE:${ORCHARD_LIBM}>)

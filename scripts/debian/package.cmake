# Three Debian packages by `cpack` in the build folder: orchard-mapper (programs, message types, pages),
# liborchard-dev (the library for other programs) and python3-orchard (map folders as numpy arrays). tests/package/deb_test.sh tries them.
set(doc ${CMAKE_INSTALL_DATADIR}/doc)

# ---- documentation ----
install(FILES LICENSE README.md CHANGELOG.md SECURITY.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
file(GLOB_RECURSE pages RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS
     lib/*.md procs/*.md lcmtypes/*.md config/*.md tests/*.md)
foreach(page ${pages})
  get_filename_component(folder ${page} DIRECTORY)
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder})
endforeach()
install(FILES scripts/examples/README.md scripts/examples/send.cpp scripts/examples/send.py
        DESTINATION ${CMAKE_INSTALL_DOCDIR}/scripts/examples)
install(FILES scripts/figures/demo_map.png DESTINATION ${CMAKE_INSTALL_DOCDIR}/scripts/figures)

# ---- what Debian wants beside it ----
include(scripts/debian/maintainer.cmake)
if(NOT ORCHARD_MAINTAINER)
  set(ORCHARD_MAINTAINER "Orchard Mapper authors")
  if(DEFINED ENV{DEBEMAIL})
    set(ORCHARD_MAINTAINER "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
  endif()
endif()
set(package_dir ${CMAKE_BINARY_DIR}/debian)
configure_file(scripts/debian/changelog.in ${package_dir}/changelog.Debian @ONLY)
find_program(GZIP gzip REQUIRED)
execute_process(COMMAND ${GZIP} -9nkf ${package_dir}/changelog.Debian COMMAND_ERROR_IS_FATAL ANY)
file(READ LICENSE licence)
string(REGEX REPLACE "^[^\n]*\n\n[^\n]*\n\n" "" licence "${licence}")  # its title and its year
string(REGEX REPLACE "\n\n" "\n.\n" licence "${licence}")
string(REGEX REPLACE "\n([^\n])" "\n \\1" licence " ${licence}")
configure_file(scripts/debian/copyright.in ${package_dir}/copyright @ONLY)
set(main_package orchard-mapper)
set(dev_package liborchard-dev)
set(python_package python3-orchard)
install(FILES scripts/python/orchard_map.py DESTINATION lib/python3/dist-packages COMPONENT python)
foreach(part main dev python)
  install(FILES ${package_dir}/copyright ${package_dir}/changelog.Debian.gz
          DESTINATION ${doc}/${${part}_package} COMPONENT ${part})
endforeach()
# The programs hold functions of musl (lib/geometry/libm.cmake): its licence goes with them.
if(ORCHARD_MUSL_LIBC AND EXISTS /usr/share/doc/musl-dev/copyright)
  install(FILES /usr/share/doc/musl-dev/copyright DESTINATION ${doc}/${main_package} RENAME copyright.musl COMPONENT main)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME orchard-mapper)
set(CPACK_PACKAGE_CONTACT ${ORCHARD_MAINTAINER})
set(CPACK_DEBIAN_PACKAGE_HOMEPAGE ${ORCHARD_HOMEPAGE})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL main dev python)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)

set(CPACK_DEBIAN_MAIN_PACKAGE_NAME ${main_package})
set(CPACK_DEBIAN_MAIN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_MAIN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_MAIN_PACKAGE_DEPENDS "fonts-dejavu-core")  # what figures are written with
set(CPACK_DEBIAN_MAIN_PACKAGE_RECOMMENDS "liblcm-bin, iproute2, chrony, default-jre, liblcm-java, libjchart2d-java")
set(CPACK_DEBIAN_MAIN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/scripts/debian/postinst)
set(CPACK_DEBIAN_MAIN_PACKAGE_SUGGESTS "liborchard-dev, python3-orchard, python3, qgis, supervisor, nftables, snakemake")
set(CPACK_DEBIAN_MAIN_DESCRIPTION "maps of tree trunks from laser scans and camera images
A robot with a 2D laser scanner and a camera drives through an orchard. Orchard
Mapper turns what they see into a map of every tree trunk and every other
object: position, width, confidence and class.

This package holds the programs, which talk over LCM, the message types for
C++, Python and Java, example configurations and the documentation.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME ${dev_package})
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
    "libeigen3-dev, libfmt-dev, libgeographiclib-dev, pkg-config")
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "libopencv-dev, libjpeg-dev, libmrpt-poses-dev, libceres-dev, libmetis-dev")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS
    "orchard-mapper, liblcm-dev, libmrpt-obs-dev, libcairo2-dev, libpng-dev, libgdal-dev, libyaml-cpp-dev, libspdlog-dev, libcli11-dev, nlohmann-json3-dev, libturbojpeg0-dev, zlib1g-dev, liblz4-dev, libzstd-dev, libbz2-dev, libsqlite3-dev, libpq-dev, libssl-dev")
set(CPACK_DEBIAN_DEV_DESCRIPTION "library to map tree trunks from laser scans (development files)
What Orchard Mapper is made of, as static libraries with headers and a CMake
package of components: geometry, laser, vision, detection, pose, mapping and
more. Each component needs the development packages of the libraries that it
stands on, which CMake names.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME ${python_package})
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3:any, python3-numpy")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "maps of tree trunks as numpy arrays (Python 3)
The module orchard_map reads a map folder of Orchard Mapper: landmarks, paths
and navigation graph. It needs nothing else of Orchard Mapper.")
include(CPack)

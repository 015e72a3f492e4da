# The libraries that this configuration uses. Two outputs come from the list below: the table of
# `sonarcal --licenses` and the software bill of materials <build>/sonarcal.spdx.json (SPDX 2.3).
#
# A package found with sonarcal_find that has no entry stops CMake. Not in the list: the C and C++ runtime
# libraries, the Python interpreter with its packages, and what a shared library uses itself.
#
# Licences are those that /usr/share/doc/<package>/copyright of Debian 12 states for the library's files.
# Exceptions: version 2 of the licence of libpng is in png.h, and the blessing of SQLite is in sqlite3.h.

# sonarcal_library_use(VARIABLE LIBRARY): how a target or a library file becomes part of the program.
function(sonarcal_library_use variable library)
  set(use linked)
  set(file "${library}")
  while(TARGET "${library}")
    get_target_property(type ${library} TYPE)
    if(NOT type STREQUAL "INTERFACE_LIBRARY")
      get_target_property(file ${library} LOCATION)
      break()
    endif()
    # pugixml::pugixml stands for pugixml::shared.
    get_target_property(library ${library} INTERFACE_LINK_LIBRARIES)
    if(NOT TARGET "${library}")
      set(use "compiled in")
    endif()
  endwhile()
  if(file MATCHES "\\.a$")
    set(use "linked statically")
  endif()
  set(${variable} "${use}" PARENT_SCOPE)
endfunction()

# sonarcal_pkg_config_version(VARIABLE LIBRARY_FILE MODULE): version in the pkg-config file of a library.
function(sonarcal_pkg_config_version variable library module)
  cmake_path(GET library PARENT_PATH folder)
  set(version "")
  if(EXISTS "${folder}/pkgconfig/${module}.pc")
    file(STRINGS "${folder}/pkgconfig/${module}.pc" version REGEX "^Version:")
    string(REGEX REPLACE "^Version: *" "" version "${version}")
  endif()
  set(${variable} "${version}" PARENT_SCOPE)
endfunction()

# sonarcal_list_library(NAME LINKED_AS target-or-file | USE "compiled in" | USE embedded
#   VERSION version LICENCE spdx-expression HOME_PAGE url [PACKAGE name for find_package] [NEEDED_BY NAME])
#
# NEEDED_BY: a library linked statically, listed before, whose code needs this one.
function(sonarcal_list_library name)
  cmake_parse_arguments(ARG "" "LINKED_AS;USE;VERSION;LICENCE;HOME_PAGE;PACKAGE;NEEDED_BY" "" ${ARGN})
  if(ARG_LINKED_AS)
    sonarcal_library_use(ARG_USE "${ARG_LINKED_AS}")
  endif()
  if(NOT ARG_VERSION)
    set(ARG_VERSION NOASSERTION)
  endif()
  set(relationship_of_linked DYNAMIC_LINK)
  set(relationship_of_linked_statically STATIC_LINK)
  set(relationship_of_compiled_in CONTAINS)
  set(relationship_of_embedded CONTAINS)
  string(REPLACE " " "_" use "${ARG_USE}")
  set(relationship "${relationship_of_${use}}")
  if(NOT relationship OR NOT ARG_LICENCE OR NOT ARG_HOME_PAGE)
    message(FATAL_ERROR "The entry of ${name} in cmake/SonarcalBillOfMaterials.cmake is not complete")
  endif()

  sonarcal_spdx_id(id "${name}")
  set(source "${ARG_USE}")
  if(ARG_PACKAGE)
    string(APPEND source ", found by find_package(${ARG_PACKAGE})")
    list(APPEND SONARCAL_LISTED_PACKAGES ${ARG_PACKAGE})
  endif()
  string(APPEND SONARCAL_SPDX_PACKAGES ",
    {
      \"SPDXID\": \"${id}\",
      \"name\": \"${name}\",
      \"versionInfo\": \"${ARG_VERSION}\",
      \"supplier\": \"NOASSERTION\",
      \"downloadLocation\": \"NOASSERTION\",
      \"homepage\": \"${ARG_HOME_PAGE}\",
      \"filesAnalyzed\": false,
      \"licenseConcluded\": \"NOASSERTION\",
      \"licenseDeclared\": \"${ARG_LICENCE}\",
      \"copyrightText\": \"NOASSERTION\",
      \"sourceInfo\": \"${source}\",
      \"primaryPackagePurpose\": \"LIBRARY\"
    }")
  sonarcal_relate(SPDXRef-Package-sonarcal ${relationship} ${id})
  if(ARG_NEEDED_BY)
    sonarcal_spdx_id(needed_by "${ARG_NEEDED_BY}")
    sonarcal_relate(${needed_by} DEPENDS_ON ${id})
  endif()
  list(APPEND SONARCAL_LIBRARY_ROWS "    {\"${name}\", \"${ARG_VERSION}\", \"${ARG_USE}\", \"${ARG_LICENCE}\"},\n")
  foreach(output LISTED_PACKAGES SPDX_PACKAGES SPDX_RELATIONSHIPS LIBRARY_ROWS)
    set(SONARCAL_${output} "${SONARCAL_${output}}" PARENT_SCOPE)
  endforeach()
endfunction()

macro(sonarcal_spdx_id variable name)
  string(REGEX REPLACE "[^A-Za-z0-9.-]" "-" ${variable} "SPDXRef-Package-${name}")
endmacro()

macro(sonarcal_relate element relationship related)
  string(APPEND SONARCAL_SPDX_RELATIONSHIPS ",
    {
      \"spdxElementId\": \"${element}\",
      \"relationshipType\": \"${relationship}\",
      \"relatedSpdxElement\": \"${related}\"
    }")
endmacro()

set(SONARCAL_LISTED_PACKAGES Threads)  # part of the C library
set(SONARCAL_SPDX_PACKAGES "")
set(SONARCAL_SPDX_RELATIONSHIPS "")
set(SONARCAL_LIBRARY_ROWS "")

# Libraries of core, data_io, metrics, sim and calib.
sonarcal_list_library(Boost LINKED_AS Boost::headers VERSION "${boost_headers_VERSION}" PACKAGE boost_headers
  LICENCE BSL-1.0 HOME_PAGE https://www.boost.org)
# BSD; its headers fixed_array.h and memory.h are Abseil's.
sonarcal_list_library("Ceres Solver" LINKED_AS Ceres::ceres VERSION "${Ceres_VERSION}" PACKAGE Ceres
  LICENCE "BSD-3-Clause AND Apache-2.0" HOME_PAGE http://ceres-solver.org)
sonarcal_list_library(Eigen LINKED_AS Eigen3::Eigen VERSION "${Eigen3_VERSION}" PACKAGE Eigen3
  LICENCE MPL-2.0 HOME_PAGE https://eigen.tuxfamily.org)
sonarcal_list_library(Embree LINKED_AS embree VERSION "${embree_VERSION}" PACKAGE embree
  LICENCE Apache-2.0 HOME_PAGE https://embree.github.io)
sonarcal_list_library(fmt LINKED_AS fmt::fmt VERSION "${fmt_VERSION}" PACKAGE fmt
  LICENCE "MIT WITH fmt-exception" HOME_PAGE https://fmt.dev)
sonarcal_list_library(bzip2 LINKED_AS BZip2::BZip2 VERSION "${BZIP2_VERSION_STRING}" PACKAGE BZip2
  LICENCE bzip2-1.0.6 HOME_PAGE https://sourceware.org/bzip2)
sonarcal_list_library(libarchive LINKED_AS LibArchive::LibArchive VERSION "${LibArchive_VERSION}" PACKAGE LibArchive
  LICENCE BSD-2-Clause HOME_PAGE https://www.libarchive.org)
sonarcal_list_library(libpng LINKED_AS PNG::PNG VERSION "${PNG_VERSION_STRING}" PACKAGE PNG
  LICENCE libpng-2.0 HOME_PAGE http://www.libpng.org/pub/png)
sonarcal_list_library(LibTIFF LINKED_AS TIFF::TIFF VERSION "${TIFF_VERSION_STRING}" PACKAGE TIFF
  LICENCE libtiff HOME_PAGE https://gitlab.com/libtiff/libtiff)
sonarcal_pkg_config_version(lz4_version "${LZ4_LIBRARY}" liblz4)
sonarcal_list_library(LZ4 LINKED_AS lz4::lz4 VERSION "${lz4_version}" PACKAGE LZ4
  LICENCE BSD-2-Clause HOME_PAGE https://github.com/lz4/lz4)
sonarcal_list_library(nlohmann-json LINKED_AS nlohmann_json::nlohmann_json VERSION "${nlohmann_json_VERSION}"
  PACKAGE nlohmann_json LICENCE MIT HOME_PAGE https://github.com/nlohmann/json)
sonarcal_list_library(oneTBB LINKED_AS TBB::tbb VERSION "${TBB_VERSION}" PACKAGE TBB
  LICENCE Apache-2.0 HOME_PAGE https://github.com/oneapi-src/oneTBB)
sonarcal_list_library(OpenCV LINKED_AS opencv_core VERSION "${OpenCV_VERSION}" PACKAGE OpenCV
  LICENCE "Apache-2.0 AND BSD-3-Clause" HOME_PAGE https://opencv.org)
sonarcal_list_library(OpenSSL LINKED_AS OpenSSL::Crypto VERSION "${OPENSSL_VERSION}" PACKAGE OpenSSL
  LICENCE Apache-2.0 HOME_PAGE https://www.openssl.org)
sonarcal_list_library(pugixml LINKED_AS pugixml::pugixml VERSION "${pugixml_VERSION}" PACKAGE pugixml
  LICENCE MIT HOME_PAGE https://pugixml.org)
sonarcal_list_library(TinyGLTF LINKED_AS TinyGLTF::TinyGLTF VERSION "${TinyGLTF_VERSION}" PACKAGE TinyGLTF
  LICENCE "MIT AND BSL-1.0" HOME_PAGE https://github.com/syoyo/tinygltf)
sonarcal_list_library(yaml-cpp LINKED_AS yaml-cpp VERSION "${yaml-cpp_VERSION}" PACKAGE yaml-cpp
  LICENCE MIT HOME_PAGE https://github.com/jbeder/yaml-cpp)
sonarcal_list_library(zlib LINKED_AS ZLIB::ZLIB VERSION "${ZLIB_VERSION_STRING}" PACKAGE ZLIB
  LICENCE Zlib HOME_PAGE http://zlib.net)
sonarcal_pkg_config_version(zstd_version "${Zstd_LIBRARY}" libzstd)
sonarcal_list_library(Zstandard LINKED_AS zstd::zstd VERSION "${zstd_version}" PACKAGE Zstd
  LICENCE "BSD-3-Clause OR GPL-2.0-only" HOME_PAGE https://github.com/facebook/zstd)

# The headers of Ceres call glog. A static Ceres is linked together with the libraries that it was built with.
# CMake knows no version of LAPACK and ATLAS. Supernodal, Modify and MatrixOps of CHOLMOD are GPL, its other
# modules LGPL.
sonarcal_library_use(ceres_use Ceres::ceres)
get_target_property(ceres_links Ceres::ceres INTERFACE_LINK_LIBRARIES)
if(ceres_links MATCHES "glog::glog")
  sonarcal_list_library(glog LINKED_AS glog::glog VERSION "${glog_VERSION}" NEEDED_BY "Ceres Solver"
    LICENCE BSD-3-Clause HOME_PAGE https://github.com/google/glog)
endif()
if(ceres_use STREQUAL "linked statically")
  if(ceres_links MATCHES "liblapack|LAPACK::")
    sonarcal_list_library(LAPACK USE linked NEEDED_BY "Ceres Solver"
      LICENCE BSD-3-Clause-Open-MPI HOME_PAGE http://www.netlib.org/lapack)
  endif()
  if(ceres_links MATCHES "f77blas")
    sonarcal_list_library(ATLAS USE linked NEEDED_BY "Ceres Solver"
      LICENCE BSD-3-Clause HOME_PAGE http://math-atlas.sourceforge.net)
  endif()
  if(ceres_links MATCHES "CXSparse::CXSparse")
    sonarcal_list_library(CXSparse LINKED_AS CXSparse::CXSparse VERSION "${CXSparse_VERSION}" NEEDED_BY "Ceres Solver"
      LICENCE LGPL-2.1-or-later HOME_PAGE http://suitesparse.com)
  endif()
  if(ceres_links MATCHES "SuiteSparse::")
    sonarcal_list_library("SuiteSparse CHOLMOD" LINKED_AS SuiteSparse::CHOLMOD VERSION "${SuiteSparse_VERSION}"
      NEEDED_BY "Ceres Solver" LICENCE "LGPL-2.1-or-later AND GPL-2.0-or-later" HOME_PAGE http://suitesparse.com)
    sonarcal_list_library("SuiteSparse SPQR" LINKED_AS SuiteSparse::SPQR VERSION "${SuiteSparse_VERSION}"
      NEEDED_BY "Ceres Solver" LICENCE GPL-2.0-or-later HOME_PAGE http://suitesparse.com)
  endif()
endif()

if(SONARCAL_WITH_ROS)
  sonarcal_list_library(SQLite LINKED_AS SQLite::SQLite3 VERSION "${SQLite3_VERSION}" PACKAGE SQLite3
    LICENCE blessing HOME_PAGE https://www.sqlite.org)
endif()

if(SONARCAL_BUILD_APPS)
  sonarcal_list_library(CLI11 LINKED_AS CLI11::CLI11 VERSION "${CLI11_VERSION}" PACKAGE CLI11
    LICENCE BSD-3-Clause HOME_PAGE https://github.com/CLIUtils/CLI11)
  if(SONARCAL_WITH_VIEW)
    sonarcal_pkg_config_version(httplib_version "${SONARCAL_HTTPLIB_LIBRARY}" cpp-httplib)
    sonarcal_list_library(cpp-httplib LINKED_AS "${SONARCAL_HTTPLIB_LIBRARY}" VERSION "${httplib_version}"
      LICENCE MIT HOME_PAGE https://github.com/yhirose/cpp-httplib)
    file(READ ${PROJECT_SOURCE_DIR}/apps/view/three/three.js three_text LIMIT 100)
    string(REGEX MATCH "three.js ([0-9.]*[0-9])" three_text "${three_text}")
    sonarcal_list_library(three.js USE embedded VERSION "${CMAKE_MATCH_1}"
      LICENCE MIT HOME_PAGE https://threejs.org)
  endif()
endif()

if(SONARCAL_WITH_PYTHON)
  sonarcal_list_library(pybind11 USE "compiled in" VERSION "${pybind11_VERSION}" PACKAGE pybind11
    LICENCE BSD-3-Clause HOME_PAGE https://github.com/pybind/pybind11)
endif()

foreach(package IN LISTS SONARCAL_FOUND_PACKAGES)
  if(NOT package IN_LIST SONARCAL_LISTED_PACKAGES)
    message(FATAL_ERROR "${package} has no entry in cmake/SonarcalBillOfMaterials.cmake")
  endif()
endforeach()

# The same list has the same namespace. The time is that of SOURCE_DATE_EPOCH, if set.
string(UUID SONARCAL_SPDX_UUID NAMESPACE 6ba7b811-9dad-11d1-80b4-00c04fd430c8 TYPE SHA1
  NAME "sonarcal ${PROJECT_VERSION}${SONARCAL_SPDX_PACKAGES}${SONARCAL_SPDX_RELATIONSHIPS}")
string(TIMESTAMP SONARCAL_SPDX_CREATED UTC)
configure_file(cmake/sonarcal.spdx.json.in ${PROJECT_BINARY_DIR}/sonarcal.spdx.json @ONLY)

if(SONARCAL_BUILD_APPS)
  list(SORT SONARCAL_LIBRARY_ROWS CASE INSENSITIVE)
  string(JOIN "" SONARCAL_LIBRARY_ROWS ${SONARCAL_LIBRARY_ROWS})
  file(READ LICENSE SONARCAL_LICENCE)
  file(READ THIRD_PARTY_NOTICES.md SONARCAL_NOTICES)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS LICENSE THIRD_PARTY_NOTICES.md)
  configure_file(apps/cli/documentation/licence_texts.h.in
    ${PROJECT_BINARY_DIR}/apps/generated/apps/cli/documentation/licence_texts.h @ONLY)
endif()

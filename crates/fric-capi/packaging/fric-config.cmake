# find_package(fric): fric::fric is the shared library, fric::static the static one.
include(CMakeFindDependencyMacro)
set(THREADS_PREFER_PTHREAD_FLAG ON)
find_dependency(Threads)

get_filename_component(_fric_lib "${CMAKE_CURRENT_LIST_DIR}/../.." ABSOLUTE)
get_filename_component(_fric_include "${_fric_lib}/../include" ABSOLUTE)

if(NOT TARGET fric::fric)
  add_library(fric::fric SHARED IMPORTED)
  set_target_properties(fric::fric PROPERTIES
    IMPORTED_LOCATION "${_fric_lib}/libfric.so.@VERSION@"
    IMPORTED_SONAME "libfric.so.@ABI@"
    INTERFACE_INCLUDE_DIRECTORIES "${_fric_include}")
  add_library(fric::static STATIC IMPORTED)
  set_target_properties(fric::static PROPERTIES
    IMPORTED_LOCATION "${_fric_lib}/libfric.a"
    IMPORTED_LINK_INTERFACE_LANGUAGES "C"
    INTERFACE_INCLUDE_DIRECTORIES "${_fric_include}"
    INTERFACE_LINK_LIBRARIES "Threads::Threads;${CMAKE_DL_LIBS};m;gcc_s")
endif()
unset(_fric_lib)
unset(_fric_include)

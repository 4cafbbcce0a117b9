# find_package(helfrich): the targets helfrich::helfrich, a shared library, and helfrich::static.
get_filename_component(helfrich_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

if(NOT TARGET helfrich::helfrich)
  add_library(helfrich::helfrich SHARED IMPORTED)
  set_target_properties(helfrich::helfrich PROPERTIES
    IMPORTED_LOCATION "${helfrich_prefix}/lib/libhelfrich_capi.so"
    IMPORTED_NO_SONAME TRUE
    INTERFACE_INCLUDE_DIRECTORIES "${helfrich_prefix}/include")

  add_library(helfrich::static STATIC IMPORTED)
  set_target_properties(helfrich::static PROPERTIES
    IMPORTED_LOCATION "${helfrich_prefix}/lib/libhelfrich_capi.a"
    INTERFACE_INCLUDE_DIRECTORIES "${helfrich_prefix}/include"
    INTERFACE_LINK_LIBRARIES "pthread;dl;m")
endif()

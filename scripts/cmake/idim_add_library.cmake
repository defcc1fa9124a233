# idim_add_library(<name> [dependencies...]) in the library's folder: target idim_<name>, alias and export idim::<name>,
# sources and headers of the folder, headers installed below include/idim as they lie in the tree.
function(idim_add_library name)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cc)
  if(sources)
    add_library(idim_${name} STATIC ${sources})
    # So that a shared library, such as a Python module, can link it.
    set_target_properties(idim_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    # Under sanitizers a room is compiled at once, in half the time (no two names of its unnamed namespaces may be the
    # same); the release build shows that a file includes what it uses.
    if(IDIM_SANITIZE)
      set_target_properties(idim_${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    endif()
    foreach(source ${sources})
      get_filename_component(room ${source} DIRECTORY)
      get_filename_component(room ${room} NAME)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${room})
    endforeach()
    set(scope PUBLIC)
    target_link_libraries(idim_${name} PRIVATE $<BUILD_INTERFACE:idim_compile_options>)
  else()
    add_library(idim_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(idim::${name} ALIAS idim_${name})
  set_target_properties(idim_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(idim_${name} ${scope} cxx_std_17)
  target_include_directories(idim_${name} ${scope} $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                     $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/idim>)
  target_link_libraries(idim_${name} ${scope} ${ARGN})
  install(TARGETS idim_${name} EXPORT idim_targets)
  install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/idim/${folder}
          FILES_MATCHING PATTERN "*.h" PATTERN "node_modules" EXCLUDE)
endfunction()

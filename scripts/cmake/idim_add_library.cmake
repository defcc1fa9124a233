# idim_add_library(<folder> [dependencies...]): target idim_<folder>, alias and export idim::<folder>, sources
# and headers of the folder, headers installed below include/idim.
function(idim_add_library folder)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cc)
  if(sources)
    add_library(idim_${folder} STATIC ${sources})
    set(scope PUBLIC)
    target_link_libraries(idim_${folder} PRIVATE $<BUILD_INTERFACE:idim_compile_options>)
  else()
    add_library(idim_${folder} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(idim::${folder} ALIAS idim_${folder})
  set_target_properties(idim_${folder} PROPERTIES EXPORT_NAME ${folder})
  target_compile_features(idim_${folder} ${scope} cxx_std_17)
  target_include_directories(idim_${folder} ${scope} $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                     $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/idim>)
  target_link_libraries(idim_${folder} ${scope} ${ARGN})
  install(TARGETS idim_${folder} EXPORT idim_targets)
  install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/idim/${folder}
          FILES_MATCHING PATTERN "*.h" PATTERN "node_modules" EXCLUDE)
endfunction()

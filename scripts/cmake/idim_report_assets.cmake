# idim_report_assets(<target>): embeds core/report/report.{html,css,js}, ECharts and its licence in the target.
function(idim_report_assets target)
  if(NOT EXISTS "${IDIM_ECHARTS_JS}")
    message(FATAL_ERROR "The plotting library of the reports is not there: ${IDIM_ECHARTS_JS}\n"
                        "Run scripts/install_dependencies.sh (it fetches ECharts by npm), "
                        "or set IDIM_ECHARTS_JS to an echarts.min.js of version 6.")
  endif()
  get_filename_component(IDIM_ECHARTS_DIR "${IDIM_ECHARTS_JS}" DIRECTORY)
  get_filename_component(IDIM_ECHARTS_DIR "${IDIM_ECHARTS_DIR}" DIRECTORY)
  set(IDIM_REPORT_DIR "${PROJECT_SOURCE_DIR}/core/report")
  set(embedded ${IDIM_REPORT_DIR}/report.html ${IDIM_REPORT_DIR}/report.css ${IDIM_REPORT_DIR}/report.js
               ${IDIM_ECHARTS_JS} ${IDIM_ECHARTS_DIR}/LICENSE ${IDIM_ECHARTS_DIR}/NOTICE
               ${IDIM_ECHARTS_DIR}/licenses/LICENSE-d3)
  foreach(file ${embedded})
    if(NOT EXISTS "${file}")
      message(FATAL_ERROR "${file} is missing: reports must carry it (ECharts' licence asks for LICENSE and NOTICE)")
    endif()
  endforeach()
  set(source ${CMAKE_CURRENT_BINARY_DIR}/report/assets.cc)
  configure_file(${IDIM_REPORT_DIR}/assets.cc.in ${source} @ONLY)
  # The compiler's dependency files do not see what the assembler includes.
  set_source_files_properties(${source} PROPERTIES OBJECT_DEPENDS "${embedded}")
  target_sources(${target} PRIVATE ${source})
  install(FILES ${IDIM_ECHARTS_DIR}/LICENSE ${IDIM_ECHARTS_DIR}/NOTICE ${IDIM_ECHARTS_DIR}/licenses/LICENSE-d3
          DESTINATION ${CMAKE_INSTALL_DOCDIR}/echarts)
endfunction()

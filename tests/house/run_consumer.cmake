# Installs the build into a fresh prefix, then configures, builds and runs the project in consumer/ against it.
# cmake -DBUILD_DIR=.. -DSOURCE_DIR=.. -DCONFIG=.. -DGENERATOR=.. -DCOMPILER=.. -DFLAGS=.. -P run_consumer.cmake
set(work ${BUILD_DIR}/tests/house/installed)
file(REMOVE_RECURSE ${work})
file(COPY ${SOURCE_DIR}/tests/house/consumer DESTINATION ${work})

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "failed (${result}): ${ARGN}\n${output}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --config ${CONFIG} --prefix ${work}/prefix)
run(${CMAKE_COMMAND} -S ${work}/consumer -B ${work}/build -G ${GENERATOR} -DCMAKE_BUILD_TYPE=${CONFIG}
    -DCMAKE_PREFIX_PATH=${work}/prefix -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS}
    -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF)

# The installed package must work with the source and the build tree gone: neither may be named.
file(GLOB_RECURSE texts ${work}/prefix/*.cmake ${work}/build/compile_commands.json)
list(LENGTH texts count)
if(count LESS 4)
  message(FATAL_ERROR "the installed CMake files are not where they were looked for: ${texts}")
endif()
foreach(file ${texts})
  file(READ ${file} text)
  string(REPLACE "${work}" "" text "${text}")
  string(FIND "${text}" "${SOURCE_DIR}" in_source)
  string(FIND "${text}" "${BUILD_DIR}" in_build)
  if(NOT in_source EQUAL -1 OR NOT in_build EQUAL -1)
    message(FATAL_ERROR "${file} names the tree it was built from")
  endif()
endforeach()

run(${CMAKE_COMMAND} --build ${work}/build)
run(${work}/build/consumer)
run(${work}/build/module_user)

# cmake -DBUILD_DIR=... -DSOURCE_DIR=... -DGENERATOR=... -DCXX=... -DFLAGS=... -P run.cmake
#
# Installs the build into a prefix of its own, builds the consumer against that and nothing else, runs it.
set(prefix ${BUILD_DIR}/consumer/prefix)
set(consumer_build ${BUILD_DIR}/consumer/build)
file(REMOVE_RECURSE ${BUILD_DIR}/consumer)

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${prefix})
run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${consumer_build} -G ${GENERATOR}
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${FLAGS}
  -DCMAKE_PREFIX_PATH=${prefix})
run(${CMAKE_COMMAND} --build ${consumer_build})
run(${prefix}/bin/sonarcal scenes --only tank --quiet --out ${consumer_build}/tank)
run(${consumer_build}/consumer ${consumer_build}/tank/params.json)

# Whoever links sonarcal::sim and sonarcal::metrics gets no library that reads files.
run(${consumer_build}/simulation)
execute_process(COMMAND readelf --dynamic ${consumer_build}/simulation
  OUTPUT_VARIABLE linked COMMAND_ERROR_IS_FATAL ANY)
if(linked MATCHES "NEEDED[^\n]*(bz2|sqlite|archive|lz4|yaml|zstd|tiff|png|imgcodecs)[^\n]*")
  message(FATAL_ERROR "A program of sonarcal::sim and sonarcal::metrics links a library of data_io: ${CMAKE_MATCH_0}")
endif()

# Builds and runs the project in consumer/ in a fresh folder; called by install_tests.cmake.

cmake_minimum_required(VERSION 3.21)

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ECHO STDOUT RESULT_VARIABLE result)
  if(result)
    message(FATAL_ERROR "install.${WAY}: the step above failed: ${result}")
  endif()
endfunction()

function(build_and_run_consumer)
  run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/consumer -B ${WORK_DIR}/build -G ${GENERATOR}
    -D CMAKE_CXX_COMPILER=${CXX} -D CMAKE_BUILD_TYPE=Release -D CMAKE_CXX_FLAGS_RELEASE=-O0 ${ARGV})
  run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
  run(${WORK_DIR}/build/consumer)
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR})
if(WAY STREQUAL "find_package")
  run(${CMAKE_COMMAND} --install ${PCS_BUILD} --prefix ${WORK_DIR}/prefix)
  # Move it: an installed package must not remember where it was put.
  file(RENAME ${WORK_DIR}/prefix ${WORK_DIR}/moved)
  build_and_run_consumer(-D CMAKE_PREFIX_PATH=${WORK_DIR}/moved
    -D PCS_LIBRARY=pcs::compiled_deformation)
elseif(WAY STREQUAL "add_subdirectory")
  build_and_run_consumer(-D PCS_ROOT=${PCS_ROOT} -D PCS_WITH_TBB=${PCS_WITH_TBB}
    -D PCS_LIBRARY=pcs::pcs)
elseif(WAY STREQUAL "debian_package") # used by CMake, and by the compiler with pkg-config
  run(cpack --config ${PCS_BUILD}/CPackConfig.cmake -B ${WORK_DIR})
  file(GLOB packages ${WORK_DIR}/*.deb)
  foreach(package IN LISTS packages)
    run(dpkg -x ${package} ${WORK_DIR}/root)
  endforeach()
  if(EXISTS ${PCS_BUILD}/examples/programs/extract_tree_skeleton)
    run(${WORK_DIR}/root/usr/bin/extract_tree_skeleton --version)
  endif()
  build_and_run_consumer(-D CMAKE_PREFIX_PATH=${WORK_DIR}/root/usr
    -D PCS_LIBRARY=pcs::compiled_deformation)
  set(ENV{PKG_CONFIG_PATH} ${WORK_DIR}/root/usr/share/pkgconfig)
  execute_process(COMMAND pkg-config --cflags --libs pcs OUTPUT_VARIABLE flags
    OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags)
  run(${CXX} -O0 ${CMAKE_CURRENT_LIST_DIR}/consumer/consumer.cpp -o ${WORK_DIR}/consumer ${flags})
  run(${WORK_DIR}/consumer)
else() # copied headers, the compiler alone, without oneTBB
  file(COPY ${PCS_ROOT}/include DESTINATION ${WORK_DIR})
  run(${CXX} -std=c++17 -O0 -I ${WORK_DIR}/include -isystem ${EIGEN_INCLUDE_DIR}
    ${CMAKE_CURRENT_LIST_DIR}/consumer/consumer.cpp -o ${WORK_DIR}/consumer -lmpfr -lgmp)
  run(${WORK_DIR}/consumer)
endif()

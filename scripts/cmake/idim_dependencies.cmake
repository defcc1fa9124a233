# What the libraries link: included by the build here and, installed beside idimConfig.cmake, by find_package(idim)
# in another project. Missing packages stop the build here; there they make idim not found, with the reason.
include(CMakeFindDependencyMacro)
macro(idim_find_package)
  if(CMAKE_FIND_PACKAGE_NAME STREQUAL "idim")
    find_dependency(${ARGN})
  else()
    find_package(${ARGN} REQUIRED)
  endif()
endmacro()

idim_find_package(Eigen3 3.4)
idim_find_package(glog)
idim_find_package(yaml-cpp 0.7)
idim_find_package(nlohmann_json 3.11)
idim_find_package(urdfdom)            # its configuration carries no version
idim_find_package(Boost 1.74 CONFIG)  # headers only; CONFIG: CMake's own FindBoost is gone from 3.30 on (CMP0167)
idim_find_package(Ceres 2.1 COMPONENTS SuiteSparse)
# libcsv has no CMake configuration: the target links it by its plain name, -lcsv.

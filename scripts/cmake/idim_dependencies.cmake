# What the libraries link, for the build here and for find_package(idim) elsewhere.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4)
find_dependency(glog)
find_dependency(yaml-cpp 0.7)
find_dependency(nlohmann_json 3.11)
find_dependency(urdfdom)
find_dependency(Boost 1.74)
find_dependency(Ceres 2.1 COMPONENTS SuiteSparse)

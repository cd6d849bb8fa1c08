# The package on ROS Noetic: Ubuntu 20.04, GCC 9, CMake 3.16, Eigen 3.3.7, pybind11 2.4.3, Python 3.8.
#   docker build --file .github/noetic.dockerfile --tag stochastic_platoon .
#   docker run --rm stochastic_platoon rosrun stochastic_platoon analyze
# Not run by the tests, as it needs Docker and the network.
#
# Known differences from Debian:
# - Package names: rosdep installs the packages of package.xml. launch/setup.bash, launch/demo and test/run use the names of
#   Debian and stop here with a message; `catkin test stochastic_platoon` runs the tests.
# - <filesystem>: GCC 8 needs libstdc++fs. GCC 9 still has this library, and CMakeLists.txt links it for both.
# - Older libraries: nlohmann-json 3.7.3, yaml-cpp 0.6.2. The sources use nothing newer.
# - Doxygen 1.8.17 does not know all options of .github/reference/Doxyfile: build the API reference on Debian 12.
# - Bits: test/compilers compares those of GCC 11, GCC 12 and Clang 14, test/distributions those of GCC 10 and 14; none those of GCC 9.
FROM ros:noetic-ros-base
RUN apt-get update \
  && apt-get install -y --no-install-recommends librandom123-dev python3-catkin-tools python3-mpmath \
  && rm -rf /var/lib/apt/lists/*
WORKDIR /workspace
COPY . src/stochastic_platoon
# By default rosdep omits distributions at the end of their life, such as Noetic.
RUN rm -rf src/stochastic_platoon/build src/stochastic_platoon/devel \
  && apt-get update \
  && rosdep update --include-eol-distros \
  && rosdep install --from-paths src --ignore-src -y \
  && rm -rf /var/lib/apt/lists/*
RUN bash -c '. /opt/ros/noetic/setup.bash && catkin build --no-status --summarize'
ENTRYPOINT ["bash", "-c", ". devel/setup.bash && exec \"$@\"", "bash"]

# Sourced by launch/demo and test/run: installs the packages, builds, and sets the ROS environment in this shell.
# Skips apt if all packages are installed, and the build if nothing changed.

platoon_packages=(
  cmake g++ make
  ros-core rosbash ros-message-generation ros-message-runtime libroscpp-dev librosbag-storage-dev libstd-msgs-dev libstd-srvs-dev libvisualization-msgs-dev ros-std-msgs ros-std-srvs
  libdiagnostic-updater-dev libdiagnostic-msgs-dev libtf2-msgs-dev
  libboost-program-options-dev libeigen3-dev libxxhash-dev libyaml-cpp-dev nlohmann-json3-dev pybind11-dev python3-dev
  python3-diagnostic-msgs python3-diagnostic-updater python3-geometry-msgs python3-matplotlib python3-nav-msgs python3-numpy
  python3-rosbag python3-rospy python3-scipy python3-std-msgs python3-std-srvs
)
platoon_test_packages=(
  catkin-lint chromium chromium-driver doxygen dpkg-dev file fonts-dejavu-core iproute2 libjs-mathjax locales munge parallel rviz slurm-wlm xvfb
  libgtest-dev librandom123-dev librostest-dev mypy python3-mpmath python3-pandas python3-rostest python3-selenium python3-yaml librosbag-dev
)
platoon_debian=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
# Packages that not every Debian has; without them the tests `installed` and `format` and a comparison in `rare` are skipped.
case $platoon_debian in
  bookworm) platoon_test_packages+=(catkin-tools clang-format-14 python3-openturns) ;;
  trixie) platoon_test_packages+=(catkin-tools python3-openturns) ;;
esac

# Installs the given packages that are missing.
platoon_install() {
  local missing=() package
  for package in "$@"; do
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return
  case $platoon_debian in
    bullseye | bookworm | trixie) ;;
    *)
      echo "Missing: ${missing[*]}. These are names of Debian 11, 12 and 13: on ROS Noetic build the package in a catkin workspace (README.md)." >&2
      return 1
      ;;
  esac
  echo "Installing: ${missing[*]}"
  local root=()
  [ "$(id -u)" -eq 0 ] || root=(sudo)
  "${root[@]}" apt-get update
  "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"
}

# Installs, builds and sets the environment. Arguments: further packages. Variables: platoon_targets: the targets to build;
# platoon_testing=ON: builds the tests (their packages are not installed otherwise).
platoon_setup() {
  case $source_folder in
    *[[:space:]]*)
      echo "$source_folder: must be a path without spaces, as roslaunch starts no program in it" >&2
      return 1
      ;;
  esac
  # Catkin fails with a python3 other than Debian's.
  export PATH=/usr/bin:$PATH
  platoon_install "${platoon_packages[@]}" "$@"
  local build=$source_folder/build devel=$source_folder/devel
  local testing=${platoon_testing:-OFF}
  # rosrun searches all of <package>/build, so the devel space is beside it. roslaunch would find each program twice if an old devel
  # space were still in build.
  if ! grep -qsxF "CATKIN_DEVEL_PREFIX:PATH=$devel" "$build/CMakeCache.txt"; then
    rm -rf "$build/devel" "$build/CMakeCache.txt"
  fi
  if [ ! -f "$build/Makefile" ] || [ ! -f "$build/CMakeCache.txt" ] || [ ! -f "$devel/setup.bash" ] ||
    { [ "$testing" = ON ] && ! grep -q '^CATKIN_ENABLE_TESTING:BOOL=ON' "$build/CMakeCache.txt"; }; then
    # Several sources at once take half the time of the first build (cmake -DCMAKE_UNITY_BUILD=OFF build: one by one). The fewer cores
    # there are, the more sources: 24 of them take 2 GB of memory.
    local unity=()
    [ -f "$build/CMakeCache.txt" ] || unity=(-DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=$(($(nproc) > 4 ? 8 : 24)))
    cmake -G "Unix Makefiles" -S "$source_folder" -B "$build" -DPYTHON_EXECUTABLE=/usr/bin/python3 -DCATKIN_DEVEL_PREFIX="$devel" \
      -DCATKIN_ENABLE_TESTING="$testing" "${unity[@]}"
  fi
  make --no-print-directory -C "$build" -j"$(nproc)" ${platoon_targets:-all}
  set +u
  . "$devel/setup.bash"
  set -u
  # Restricts all traffic to this machine.
  export ROS_HOSTNAME=localhost
  unset ROS_IP
}

# Prints a TCP port for a master: currently free, and outside the range from which the system assigns ports.
platoon_free_port() {
  /usr/bin/python3 - <<'PYTHON'
import random, socket
while True:
    port = random.randrange(20000, 32000)
    try:
        socket.socket().bind(("localhost", port))
        print(port)
        break
    except OSError:
        continue
PYTHON
}

# The end of an installation by cpack: removes catkin's files at the top of a workspace, and replaces the prefix that was configured by
# that of the package. Variables: package, its name; configured, the prefix.
set(staged "$ENV{DESTDIR}${configured}")
if(NOT "$ENV{DESTDIR}" STREQUAL "" AND NOT CMAKE_INSTALL_PREFIX STREQUAL configured)
  file(GLOB of_workspace "${staged}/*setup.*" "${staged}/_setup_util.py" "${staged}/env.sh" "${staged}/.catkin" "${staged}/.rosinstall")
  file(REMOVE ${of_workspace})
  set(installed "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}")
  foreach(file lib/pkgconfig/${package}.pc share/${package}/cmake/${package}Config.cmake)
    file(READ "${installed}/${file}" text)
    string(REPLACE "${configured}" "${CMAKE_INSTALL_PREFIX}" text "${text}")
    file(WRITE "${installed}/${file}" "${text}")
  endforeach()
endif()

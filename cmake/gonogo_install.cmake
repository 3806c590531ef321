# Installs the library, the program, and what both need; include it last.
#
# The public headers are include/gonogo/*.h and what they include, found by following their #include lines: nothing else
# is installed. Libraries form components, each with an export set of its own, so that a user of `sim` needs neither
# GDAL nor LibTorch nor cairo:
#
#   find_package(gonogo 0.2 REQUIRED COMPONENTS sim)
#   target_link_libraries(mine gonogo::vehicle)

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Component of a library, by the folder that defines it. A component may use those before it.
set(gonogo_components sim report learn map lab)
set(folders_sim base sim vehicle terrain pipeline/campaign)
set(folders_report pipeline/report pipeline/inspect)
set(folders_learn learning pipeline/outcome)
set(folders_map pipeline/map)
set(folders_lab pipeline/lab)
# The libraries of their folders that need GDAL.
set(component_of_map_figure map)
set(component_of_raster map)

# Public headers: a header and all that it includes from this project, by paths from the source root.
function(gonogo_follow_header header)
  get_property(found GLOBAL PROPERTY gonogo_public_headers)
  if(header IN_LIST found)
    return()
  endif()
  set_property(GLOBAL APPEND PROPERTY gonogo_public_headers "${header}")
  file(STRINGS "${PROJECT_SOURCE_DIR}/${header}" lines REGEX "^[ \t]*#[ \t]*include[ \t]*\"")
  foreach(line ${lines})
    string(REGEX REPLACE "^[ \t]*#[ \t]*include[ \t]*\"([^\"]*).*" "\\1" included "${line}")
    gonogo_follow_header("${included}")
  endforeach()
endfunction()

file(GLOB faces RELATIVE "${PROJECT_SOURCE_DIR}" "${PROJECT_SOURCE_DIR}/include/gonogo/*.h")
foreach(face ${faces})
  gonogo_follow_header("${face}")
endforeach()
get_property(headers GLOBAL PROPERTY gonogo_public_headers)
foreach(header ${headers})
  get_filename_component(folder "${header}" DIRECTORY)
  if(folder STREQUAL "include/gonogo")
    set(folder "")
  endif()
  install(FILES "${PROJECT_SOURCE_DIR}/${header}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/gonogo/${folder}")
endforeach()

# Libraries, each in the export set of its component.
get_property(libraries GLOBAL PROPERTY gonogo_libraries)
set(installed_components "")
foreach(library ${libraries})
  get_target_property(folder gonogo_${library} SOURCE_DIR)
  file(RELATIVE_PATH folder "${PROJECT_SOURCE_DIR}" "${folder}")
  set(component "")
  foreach(candidate ${gonogo_components})
    foreach(root ${folders_${candidate}})
      if(folder STREQUAL root OR folder MATCHES "^${root}/")
        set(component ${candidate})
      endif()
    endforeach()
  endforeach()
  if(DEFINED component_of_${library})
    set(component ${component_of_${library}})
  endif()
  if(component)
    set_target_properties(gonogo_${library} PROPERTIES EXPORT_NAME ${library})
    target_include_directories(gonogo_${library} INTERFACE
      "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>" "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/gonogo>")
    install(TARGETS gonogo_${library} EXPORT gonogo-${component} ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
    list(APPEND installed_components ${component})
  endif()
endforeach()
list(REMOVE_DUPLICATES installed_components)

set(package_folder "${CMAKE_INSTALL_LIBDIR}/cmake/gonogo")
foreach(component ${installed_components})
  install(EXPORT gonogo-${component} NAMESPACE gonogo:: FILE gonogo-${component}-targets.cmake DESTINATION "${package_folder}")
endforeach()
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/gonogoConfig.cmake.in" "${CMAKE_CURRENT_BINARY_DIR}/gonogoConfig.cmake"
  INSTALL_DESTINATION "${package_folder}")
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/gonogoConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/gonogoConfig.cmake" "${CMAKE_CURRENT_BINARY_DIR}/gonogoConfigVersion.cmake"
  DESTINATION "${package_folder}")

# The files that ship by name: vehicles, soils, studies, regions and their schema. pipeline/app installs the program.
install(DIRECTORY "${PROJECT_SOURCE_DIR}/configs" DESTINATION "${CMAKE_INSTALL_DATADIR}/gonogo")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/python/qgis/gonogo" DESTINATION "${CMAKE_INSTALL_DATADIR}/gonogo/qgis"
        PATTERN __pycache__ EXCLUDE)
gonogo_install_models("${CMAKE_INSTALL_DATADIR}/gonogo")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" "${PROJECT_SOURCE_DIR}/README.md" DESTINATION "${CMAKE_INSTALL_DOCDIR}")

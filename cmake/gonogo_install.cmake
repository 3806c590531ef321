# Installs the library, the program, and what both need; include it last.
#
# The public headers are exactly include/gonogo/*.h. Each is a component of the package and a target of it:
#
#   find_package(gonogo 0.2 REQUIRED COMPONENTS sim vehicle)
#   target_link_libraries(mine gonogo::vehicle)
#
# Static libraries need the internal ones behind them as archives. Those export no include folder, and their targets are
# called gonogo::internal_<name>. All are exported in sets by the third-party libraries that they need, so that a user
# of `sim` needs neither GDAL nor LibTorch nor cairo. CMake refuses a library that no set holds.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(faces sim terrain vehicle campaign qubo learn map)
set(gonogo_sets core report answers training maps)
set(set_core face_common face_sim face_terrain face_vehicle face_campaign
    version base ranks json hdf5 sim divided sim_io divided_io vehicle bed soil study design trial dataset campaign study_campaign)
set(set_report figure picture)                                                           # cairo, libpng
set(set_answers face_qubo learning hardware regression words outcome teacher map_rules trained_model family_member) # Boost
set(set_training face_learn active rbm train)                                            # LibTorch
set(set_maps face_map map map_figure map_request page raster route route_search)  # GDAL

install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/gonogo" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" FILES_MATCHING PATTERN "*.h")

set(package_folder "${CMAKE_INSTALL_LIBDIR}/cmake/gonogo")
set(gonogo_installed "")
foreach(face ${faces})
  if(TARGET gonogo_face_${face})
    list(APPEND gonogo_installed ${face})
  endif()
endforeach()
foreach(set ${gonogo_sets})
  foreach(library ${set_${set}})
    if(TARGET gonogo_${library})
      string(REGEX REPLACE "^face_" "" exported "${library}")
      if(exported STREQUAL library)
        set(exported internal_${library})
      endif()
      set_target_properties(gonogo_${library} PROPERTIES EXPORT_NAME ${exported})
      install(TARGETS gonogo_${library} EXPORT gonogo-${set} ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
    endif()
  endforeach()
  if(NOT set STREQUAL "maps" OR GONOGO_GDAL)
    install(EXPORT gonogo-${set} NAMESPACE gonogo:: FILE gonogo-${set}-targets.cmake DESTINATION "${package_folder}")
  endif()
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

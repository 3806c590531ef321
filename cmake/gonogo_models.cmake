# gonogo_install_models(<folder> [argument of install()...]): the trained models that ship, with their trials and cards, which
# are found by name in <folder>/data.
function(gonogo_install_models folder)
  file(GLOB models RELATIVE "${PROJECT_SOURCE_DIR}" CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/data/*/model.h5")
  foreach(model ${models})
    get_filename_component(place "${model}" DIRECTORY)
    install(FILES "${PROJECT_SOURCE_DIR}/${place}/model.h5" "${PROJECT_SOURCE_DIR}/${place}/dataset.h5"
                  "${PROJECT_SOURCE_DIR}/${place}/README.md" DESTINATION "${folder}/${place}" ${ARGN})
  endforeach()
  # Older trials of the HMMWV, which configs/studies/demo.json learns beside the own ones.
  install(FILES "${PROJECT_SOURCE_DIR}/data/hmmwv_32mm_unsolved/dataset.h5" "${PROJECT_SOURCE_DIR}/data/hmmwv_32mm_unsolved/README.md"
          DESTINATION "${folder}/data/hmmwv_32mm_unsolved" ${ARGN})
endfunction()

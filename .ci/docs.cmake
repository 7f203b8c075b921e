# The target docs: the API documentation of the public headers, in docs/html of the build tree.

find_program(VECINO_DOXYGEN doxygen DOC "Doxygen, 1.9.4 or later, for the target docs and its test")

set(doxygen_input "\"${PROJECT_SOURCE_DIR}/core/api.md\"")
foreach(target IN ITEMS vecino_core vecino_filters)
    get_target_property(headers ${target} HEADER_SET)
    get_target_property(directory ${target} SOURCE_DIR)
    foreach(header IN LISTS headers)
        cmake_path(ABSOLUTE_PATH header BASE_DIRECTORY ${directory})
        string(APPEND doxygen_input " \"${header}\"")
    endforeach()
endforeach()
configure_file(.ci/Doxyfile ${PROJECT_BINARY_DIR}/Doxyfile @ONLY)

if(VECINO_DOXYGEN)
    add_custom_target(docs
        COMMAND ${VECINO_DOXYGEN} ${PROJECT_BINARY_DIR}/Doxyfile
        COMMENT "API documentation: ${PROJECT_BINARY_DIR}/docs/html/index.html" VERBATIM)
endif()

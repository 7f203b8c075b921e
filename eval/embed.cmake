# SPDX-License-Identifier: Apache-2.0
#
# Text files inside the program, so that it needs no file beside itself at run time.
#
#   vecino_embed_texts(TARGET OUTPUT.cpp HEADER NAME=FILE...)
#
# adds a source to TARGET that defines, for each pair, `const std::string_view NAME` with the bytes of FILE. HEADER
# declares the names. The source is made anew whenever a file changes. Run as a script (cmake -P), this file makes it.

if(NOT CMAKE_SCRIPT_MODE_FILE)
    set(VECINO_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_FILE})

    function(vecino_embed_texts target output header)
        set(output ${CMAKE_CURRENT_BINARY_DIR}/${output})
        set(files)
        foreach(pair IN LISTS ARGN)
            string(REGEX REPLACE "^[^=]*=" "" file "${pair}")
            list(APPEND files ${file})
        endforeach()
        add_custom_command(
            OUTPUT ${output}
            COMMAND ${CMAKE_COMMAND} -D "OUTPUT=${output}" -D "HEADER=${header}" -D "PAIRS=${ARGN}"
                    -P ${VECINO_EMBED_SCRIPT}
            WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}
            DEPENDS ${files} ${VECINO_EMBED_SCRIPT}
            COMMENT "Embedding ${ARGN}"
            VERBATIM)
        target_sources(${target} PRIVATE ${output})
    endfunction()
    return()
endif()

set(source "// Made by eval/embed.cmake.\n#include \"${HEADER}\"\n\nnamespace vecino {\n")
foreach(pair IN LISTS PAIRS)
    string(REGEX MATCH "^([^=]*)=(.*)$" pair "${pair}")
    set(name ${CMAKE_MATCH_1})
    file(READ "${CMAKE_MATCH_2}" text)
    # A browser's debugger would look for the file that this names.
    string(REGEX REPLACE "//# sourceMappingURL=[^\n]*" "" text "${text}")
    # The bytes are kept as they are by a raw string; this delimiter is in no text.
    string(FIND "${text}" ")VECINO_TEXT\"" clash)
    if(NOT clash EQUAL -1)
        message(FATAL_ERROR "${CMAKE_MATCH_2}: holds )VECINO_TEXT\", which ends the string that it is embedded as")
    endif()
    string(APPEND source "\nstatic const char ${name}_text[] = R\"VECINO_TEXT(${text})VECINO_TEXT\";\n"
                         "const std::string_view ${name}{${name}_text, sizeof ${name}_text - 1};\n")
endforeach()
string(APPEND source "\n}  // namespace vecino\n")
file(WRITE "${OUTPUT}" "${source}")

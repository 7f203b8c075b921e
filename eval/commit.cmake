# SPDX-License-Identifier: Apache-2.0
#
# Tells the program which commit it was built from.
#
#   vecino_add_commit(TARGET OUTPUT.cpp)
#
# adds a source to TARGET that defines `const std::string_view kCommit`: what `git describe` says of the source tree at
# build time, or nothing where there is no repository or no git, as in a release's archive. The source only changes with
# the commit. Run as a script (cmake -P), this file makes it.

if(NOT CMAKE_SCRIPT_MODE_FILE)
    set(VECINO_COMMIT_SCRIPT ${CMAKE_CURRENT_LIST_FILE})

    function(vecino_add_commit target output)
        set(output ${CMAKE_CURRENT_BINARY_DIR}/${output})
        add_custom_target(${target}_commit
            COMMAND ${CMAKE_COMMAND} -D "OUTPUT=${output}" -D "SOURCE=${PROJECT_SOURCE_DIR}" -P ${VECINO_COMMIT_SCRIPT}
            BYPRODUCTS ${output}
            VERBATIM)
        add_dependencies(${target} ${target}_commit)
        target_sources(${target} PRIVATE ${output})
    endfunction()
    return()
endif()

# A repository that this tree only lies within is another project's.
set(commit "")
find_program(git git)
if(git AND EXISTS "${SOURCE}/.git")
    execute_process(COMMAND ${git} -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
        OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
set(text "// Made by eval/commit.cmake.
#include \"eval/commands.h\"

namespace vecino {

const std::string_view kCommit{\"${commit}\"};

}  // namespace vecino
")
if(EXISTS "${OUTPUT}")
    file(READ "${OUTPUT}" before)
endif()
if(NOT "${before}" STREQUAL "${text}")
    file(WRITE "${OUTPUT}" "${text}")
endif()

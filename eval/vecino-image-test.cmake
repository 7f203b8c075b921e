# A test that renders an image and holds it against baselines:
#
#   vecino_add_image_test(
#       NAME sphere                        # of the test
#       COMMAND app --out sphere.exr       # makes the image; a target's name stands for its program
#       IMAGE sphere.exr                   # from the working directory
#       BASELINE baselines/sphere.exr      # from the source directory
#       [MIN_PSNR 40] [MIN_SSIM 0.99] [MAX_RELMSE 0.01] [UNBIASED]
#       [WORKING_DIRECTORY dir])           # the binary directory unless given
#
# Beside sphere.exr there may be sphere_1.exr, sphere_2.exr, ...: the best match counts. At least one limit has to be
# given; UNBIASED asks for renders of the same expectation, both with the planes variance and count. A missing baseline
# fails. test.png, valid.png and difference.png go to <working directory>/image_tests/NAME; measurements and pictures
# are printed for CDash. A command that exits with 125 skips the test.

set(vecino_image_test_script "${CMAKE_CURRENT_LIST_DIR}/vecino-run-image-test.cmake")

function(vecino_add_image_test)
    cmake_parse_arguments(PARSE_ARGV 0 test "UNBIASED"
        "NAME;IMAGE;BASELINE;MIN_PSNR;MIN_SSIM;MAX_RELMSE;WORKING_DIRECTORY" "COMMAND")
    if(test_UNPARSED_ARGUMENTS OR test_KEYWORDS_MISSING_VALUES)
        message(FATAL_ERROR "vecino_add_image_test: found ${test_UNPARSED_ARGUMENTS} "
            "${test_KEYWORDS_MISSING_VALUES}, allowed: keywords that it knows, each with a value")
    endif()
    foreach(key IN ITEMS NAME COMMAND IMAGE BASELINE)
        if(NOT test_${key})
            message(FATAL_ERROR "vecino_add_image_test: found no ${key}, allowed: with one")
        endif()
    endforeach()
    set(limits)
    foreach(limit IN ITEMS MIN_PSNR MIN_SSIM MAX_RELMSE)
        if(DEFINED test_${limit})
            string(TOLOWER ${limit} flag)
            string(REPLACE _ - flag ${flag})
            list(APPEND limits --${flag} ${test_${limit}})
        endif()
    endforeach()
    if(test_UNBIASED)
        list(APPEND limits --test unbiased)
    endif()
    if(NOT limits)
        message(FATAL_ERROR "vecino_add_image_test: found no limit, allowed: MIN_PSNR, MIN_SSIM, MAX_RELMSE or UNBIASED")
    endif()
    if(NOT test_WORKING_DIRECTORY)
        set(test_WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
    endif()
    list(POP_FRONT test_COMMAND program)
    if(TARGET ${program})
        set(program $<TARGET_FILE:${program}>)
    endif()
    cmake_path(ABSOLUTE_PATH test_BASELINE BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    add_test(NAME ${test_NAME} WORKING_DIRECTORY ${test_WORKING_DIRECTORY}
        COMMAND ${CMAKE_COMMAND} -D "command=${program};${test_COMMAND}" -D "vecino=${vecino_PROGRAM}"
            -D "image=${test_IMAGE}" -D "baseline=${test_BASELINE}" -D "artefacts=image_tests/${test_NAME}"
            -D "limits=${limits}" -P ${vecino_image_test_script})
    set_tests_properties(${test_NAME} PROPERTIES SKIP_REGULAR_EXPRESSION "vecino: image test skipped")
endfunction()

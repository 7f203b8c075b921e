# Runs one test of vecino_add_image_test. Given: command, vecino, image, baseline, artefacts, limits.

file(REMOVE ${image})  # one of an earlier run proves nothing
execute_process(COMMAND ${command} RESULT_VARIABLE result COMMAND_ECHO STDOUT)
if(result EQUAL 125)
    message("vecino: image test skipped")
    return()
endif()
if(NOT result EQUAL 0)
    message(FATAL_ERROR "the command that makes the image failed: ${result}")
endif()
execute_process(COMMAND ${vecino} compare ${image} ${baseline} --series --ctest ${artefacts} ${limits}
    RESULT_VARIABLE result COMMAND_ECHO STDOUT)
if(NOT result EQUAL 0)
    message(FATAL_ERROR "${image} is not as ${baseline}: vecino compare says ${result}")
endif()

# Installs the build into a fresh folder and moves it elsewhere; builds and runs tests/example there as a user would;
# holds the image that it makes against a reference.
# Usage: cmake -D source_dir=... -D build_dir=... -D config=... -P installed_library.cmake

set(work_dir ${build_dir}/installed_library)
set(prefix ${work_dir}/prefix)
set(example_dir ${work_dir}/example)

function(run)
    execute_process(COMMAND ${ARGN} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# The value of a cache entry of the build.
function(get_cached variable entry)
    file(STRINGS ${build_dir}/CMakeCache.txt line REGEX "^${entry}:")
    string(REGEX REPLACE "^[^=]*=" "" value "${line}")
    set(${variable} "${value}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${work_dir})
run(${CMAKE_COMMAND} --install ${build_dir} --config ${config} --prefix ${work_dir}/first_prefix)
file(RENAME ${work_dir}/first_prefix ${prefix})
file(GLOB_RECURSE installed ${prefix}/*.cmake ${prefix}/*.h)
foreach(file IN LISTS installed)
    file(READ ${file} text)
    foreach(place IN ITEMS ${source_dir} ${build_dir})
        string(FIND "${text}" ${place} found)
        if(NOT found EQUAL -1)
            message(FATAL_ERROR "${file}: found ${place}, allowed: nothing of the machine that built it")
        endif()
    endforeach()
endforeach()

# With the compiler, the flags and the libraries of the build.
set(settings -D vecino_ROOT=${prefix})
foreach(entry IN ITEMS CMAKE_MAKE_PROGRAM CMAKE_TOOLCHAIN_FILE CMAKE_PREFIX_PATH CMAKE_BUILD_TYPE CMAKE_CXX_COMPILER
        CMAKE_CXX_COMPILER_LAUNCHER CMAKE_EXE_LINKER_FLAGS embree_DIR OpenImageIO_DIR glm_DIR nlohmann_json_DIR)
    get_cached(value ${entry})
    if(value)
        string(REPLACE ";" "\\;" value "${value}")
        list(APPEND settings -D "${entry}=${value}")
    endif()
endforeach()
get_cached(flags CMAKE_CXX_FLAGS)
get_cached(sanitize VECINO_SANITIZE)
if(sanitize)
    string(APPEND flags " -fsanitize=address,undefined")
endif()
get_cached(generator CMAKE_GENERATOR)
run(${CMAKE_COMMAND} -G ${generator} -S ${source_dir}/tests/example -B ${example_dir}
    -D "CMAKE_CXX_FLAGS=${flags}" ${settings})
run(${CMAKE_COMMAND} --build ${example_dir} --config ${config})
run(${CMAKE_CTEST_COMMAND} --test-dir ${example_dir} -C ${config} --output-on-failure)

# It has 27 dB, a black image 8.
run(${prefix}/bin/vecino compare ${example_dir}/cornell.exr ${source_dir}/tests/data/cornell_depth2_128.exr
    --min-psnr 25)

# Its image test took the second baseline, and left pictures. With the first alone it would have failed: it can.
foreach(picture IN ITEMS test valid difference)
    if(NOT EXISTS ${example_dir}/image_tests/cornell_image/${picture}.png)
        message(FATAL_ERROR "the image test left no ${picture}.png")
    endif()
endforeach()
execute_process(COMMAND ${prefix}/bin/vecino compare ${example_dir}/cornell_image.exr
    ${source_dir}/tests/example/baselines/cornell.exr --min-psnr 50 RESULT_VARIABLE result OUTPUT_QUIET)
if(NOT result EQUAL 2)
    message(FATAL_ERROR "the first baseline alone: found exit code ${result}, allowed: 2")
endif()
